#include <core/stopwatch.hpp>
#include <viewer/server/hub.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace supple {

namespace {

constexpr int most_pending = 64;         // requests or answers of one client
constexpr std::size_t most_texts = 256;  // that wait for a client; older warnings go first
constexpr double between_states = 0.05, between_progress = 0.1, between_frames = 0.004;  // [s]

double now() {
  static const Stopwatch watch;
  return watch.seconds();
}

}  // namespace

Hub::Hub(std::function<void()> wake) : wake_(std::move(wake)) {}

void Hub::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Hub::progress(std::string_view stage, double share) {
  {
    const std::lock_guard lock(mutex_);
    if (share > 0 && share < 1 && now() - told_progress_ < between_progress) return;
    told_progress_ = now();
    progress_ = std::make_shared<const std::string>(progress_text(stage, share));
    for (auto& [id, client] : clients_)
      if (client.texts.size() < most_texts) client.texts.push_back(progress_);
  }
  wake_();
}

void Hub::serve(std::shared_ptr<const ViewModel> model) {
  auto resources = std::make_shared<const Resources>(model_resources(*model));
  auto session = std::make_shared<ViewSession>(model);
  {
    const std::lock_guard lock(mutex_);
    model_ = std::move(model);
    resources_ = std::move(resources);
    for (auto& [id, client] : clients_) {
      client.texts.push_back(std::make_shared<const std::string>(ready_text()));
      jobs_.push_back({id, "", {}, Job::Kind::Join});
    }
  }
  thread_ = std::thread([this, session] { run(*session); });
  wake_();
}

std::shared_ptr<const Resources> Hub::resources() const {
  const std::lock_guard lock(mutex_);
  return resources_;
}

int Hub::connect() {
  const std::lock_guard lock(mutex_);
  const int id = ++last_client_;
  Client& client = clients_[id];
  client.texts.push_back(std::make_shared<const std::string>(hello_text(id, static_cast<Index>(clients_.size()))));
  if (model_) {
    client.texts.push_back(std::make_shared<const std::string>(ready_text()));
    jobs_.push_back({id, "", {}, Job::Kind::Join});
    work_.notify_one();
  } else if (progress_) {
    client.texts.push_back(progress_);
  }
  return id;
}

void Hub::disconnect(int client) {
  const std::lock_guard lock(mutex_);
  if (clients_.erase(client) == 0 || !model_) return;
  jobs_.push_back({client, "", {}, Job::Kind::Leave});
  work_.notify_one();
}

void Hub::post(Job job) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(job.client);
    if (found == clients_.end()) return;
    ++found->second.pending;
    jobs_.push_back(std::move(job));
  }
  work_.notify_one();
}

void Hub::refuse(int client, std::string_view action, std::string_view reason) {
  tell(client, refused_text(action, reason));
}

void Hub::tell(int id, std::string text) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(id);
    if (found == clients_.end()) return;
    found->second.texts.push_back(std::make_shared<const std::string>(std::move(text)));
  }
  wake_();
}

void Hub::tell_all(const std::string& text) {
  const auto shared = std::make_shared<const std::string>(text);
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, client] : clients_) {
      if (client.texts.size() >= most_texts) client.texts.pop_front();
      client.texts.push_back(shared);
    }
  }
  wake_();
}

bool Hub::receive(int id, std::string_view text) {
  std::shared_ptr<const ViewModel> model;
  {
    const std::lock_guard lock(mutex_);
    model = model_;
  }
  if (!model) {
    refuse(id, "", "the model is not ready yet");
    return true;
  }
  ReadMessage read;
  try {
    read = read_message(text, *model);
  } catch (const Refusal& refusal) {
    refuse(id, refusal.what_to_do, refusal.what());
    return true;
  } catch (const NoMessage&) {
    return false;
  }
  if (auto* request = std::get_if<Request>(&read.message)) {
    post({id, std::move(read.what_to_do), std::move(*request)});
  } else if (std::holds_alternative<message::Save>(read.message)) {
    post({id, std::move(read.what_to_do), {}, Job::Kind::Save});
  } else {
    std::unique_lock lock(mutex_);
    const auto found = clients_.find(id);
    if (found == clients_.end()) return false;
    Client& client = found->second;
    if (const auto* stream = std::get_if<message::Stream>(&read.message)) {
      client.changed_kind = client.kind != stream->what;
      client.kind = stream->what;
    } else {
      const std::uint32_t frame = std::get<message::Ack>(read.message).frame;
      if (frame == client.sent) client.acknowledged = true;
      if (frame > client.sent) {
        lock.unlock();
        refuse(id, read.what_to_do, "frame " + std::to_string(frame) + " was not sent");
      }
    }
  }
  return true;
}

bool Hub::wants_more(int id) const {
  const std::lock_guard lock(mutex_);
  const auto found = clients_.find(id);
  return found != clients_.end() && found->second.pending < most_pending && found->second.texts.size() < most_pending;
}

std::optional<Outgoing> Hub::next(int id) {
  std::shared_ptr<const ViewFrame> frame;
  std::shared_ptr<const ViewModel> model;
  std::uint32_t number = 0;
  StreamKind kind{};
  {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(id);
    if (found == clients_.end()) return {};
    Client& client = found->second;
    if (!client.texts.empty()) {
      auto text = std::move(client.texts.front());
      client.texts.pop_front();
      return Outgoing{std::move(text)};
    }
    if (client.wants_state && state_) {
      client.wants_state = false;
      return Outgoing{state_};
    }
    if (!client.joined || !client.acknowledged || (client.sent == frame_number_ && !client.changed_kind)) return {};
    client.acknowledged = client.changed_kind = false;
    client.sent = number = frame_number_;
    kind = client.kind;
    frame = frame_;
    model = model_;
  }
  auto& [made_for, bytes] = bytes_[kind];
  if (made_for != number || !bytes) {
    bytes = std::make_shared<const std::string>(frame_bytes(*frame, number, kind, model->geometry));
    made_for = number;
  }
  return Outgoing{bytes, true};
}

void Hub::run(ViewSession& session) {
  double last = now();
  publish(session);
  while (true) {
    std::deque<Job> jobs;
    {
      std::unique_lock lock(mutex_);
      double wait = session.until_due();
      if (wait > 0) wait = std::max(wait, between_frames);
      if (changes_ != session.num_changes()) wait = std::min(wait, between_states);
      const auto something = [&] { return ending_ || !jobs_.empty(); };
      if (std::isinf(wait))
        work_.wait(lock, something);
      else if (wait > 0)
        work_.wait_for(lock, std::chrono::duration<double>(wait), something);
      if (ending_) return;
      jobs.swap(jobs_);
    }
    try {
      const double time = now();
      session.advance(time - std::exchange(last, time));
      for (const Job& job : jobs) follow(session, job);
      if (!jobs.empty()) session.advance(0);  // what they asked for shows at once
      publish(session);
    } catch (const std::exception& error) {  // of no message, such as want of memory
      tell_all(warning_text(error.what()));
    }
  }
}

void Hub::follow(ViewSession& session, const Job& job) {
  std::string answer;
  bool joins = false;
  try {
    switch (job.kind) {
      case Job::Kind::Apply:
        session.apply(job.client, *job.request);
        break;
      case Job::Kind::Save:
        answer = saved_text(session.edit().scene(), node_places(session.model().model.body));
        break;
      case Job::Kind::Join:
        session.join(job.client);
        joins = true;
        break;
      case Job::Kind::Leave:
        session.leave(job.client);
        return;
    }
  } catch (const std::exception& error) {
    answer = refused_text(job.action, error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(job.client);
    if (found == clients_.end()) return;
    Client& client = found->second;
    if (joins)
      client.joined = client.wants_state = true;
    else
      --client.pending;
    if (!answer.empty()) client.texts.push_back(std::make_shared<const std::string>(std::move(answer)));
  }
  wake_();
}

void Hub::publish(ViewSession& session) {
  for (const std::string& text : session.take_warnings()) tell_all(warning_text(text));
  std::shared_ptr<const ViewFrame> frame;
  if (moments_ != session.num_moments()) {
    moments_ = session.num_moments();
    frame = std::make_shared<const ViewFrame>(session.frame());
  }
  std::shared_ptr<const std::string> state;
  if (changes_ != session.num_changes() && now() - last_state_ >= std::max(between_states, 10 * state_seconds_)) {
    changes_ = session.num_changes();
    last_state_ = now();
    state = std::make_shared<const std::string>(state_text(session));
    state_seconds_ = now() - last_state_;  // large handles make long texts: they take a tenth of the time at most
  }
  if (!frame && !state) return;
  {
    const std::lock_guard lock(mutex_);
    if (frame) {
      frame_ = std::move(frame);
      ++frame_number_;
    }
    if (state) {
      state_ = std::move(state);
      for (auto& [id, client] : clients_) client.wants_state = client.joined;
    }
  }
  wake_();
}

}  // namespace supple
