#pragma once
/// \file Hub between clients and the session that runs in a thread of its own; knows no network.

#include <viewer/server/messages.hpp>
#include <viewer/server/resource.hpp>

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace supple {

/// What goes to a client.
struct Outgoing {
  std::shared_ptr<const std::string> bytes;
  bool is_frame = false;  ///< binary, or else text
};

/// Speaks the protocol of docs/viewer-protocol.md with any number of clients, for one session. A client gets no frame before
/// it has acknowledged the last, and then the newest; of states, too, only the newest waits. So nobody who is slow costs
/// anything or stalls anybody. Safe from several threads, but next() is for one of them at a time.
class Hub {
 public:
  /// \param wake  called from any thread when next() or wants_more() may say something new.
  explicit Hub(std::function<void()> wake);
  ~Hub() { end(); }
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  /// Until there is a model: how far it is.
  void progress(std::string_view stage, double share);
  /// Starts the session, in its thread. \pre called once. \throws as ViewSession.
  void serve(std::shared_ptr<const ViewModel> model);
  /// Of the model; null before it is served.
  std::shared_ptr<const Resources> resources() const;

  /// Ends the session's thread, before whatever is woken goes.
  void end();

  int connect();  ///< \return the client's number
  void disconnect(int client);
  /// A text that came. \return false if it was no message at all: the connection is to be closed.
  bool receive(int client, std::string_view text);
  /// Tells a client that what it sent is not followed.
  void refuse(int client, std::string_view action, std::string_view reason);
  /// Whether to read on from a client: false while much of what it has sent waits, or what it was answered.
  bool wants_more(int client) const;
  /// What to send to a client now; nothing if there is nothing.
  std::optional<Outgoing> next(int client);

 private:
  struct Client {
    StreamKind kind = StreamKind::Coordinates;
    std::uint32_t sent = 0;     // the last frame
    bool acknowledged = true;   // it
    bool changed_kind = false;  // since
    bool joined = false;        // the session
    bool wants_state = false;
    std::deque<std::shared_ptr<const std::string>> texts;
    int pending = 0;  // requests that wait
  };
  /// What the session's thread is to do for a client; neither a request nor a save: the client leaves or comes.
  struct Job {
    int client;
    std::string action;
    std::optional<Request> request;
    enum class Kind { Apply, Save, Join, Leave } kind = Kind::Apply;
  };

  void run(ViewSession& session);
  void follow(ViewSession& session, const Job& job);
  void publish(ViewSession& session);
  void tell(int client, std::string text);
  void tell_all(const std::string& text);
  void post(Job job);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::shared_ptr<const ViewModel> model_;
  std::shared_ptr<const Resources> resources_;
  std::map<int, Client> clients_;
  int last_client_ = 0;
  std::deque<Job> jobs_;
  bool ending_ = false;
  std::shared_ptr<const std::string> progress_;  // the last
  double told_progress_ = -1;                    // when [s]
  std::shared_ptr<const ViewFrame> frame_;
  std::uint32_t frame_number_ = 0;
  std::shared_ptr<const std::string> state_;

  // of the session's thread alone
  Index moments_ = 0, changes_ = 0;
  double last_state_ = -1, state_seconds_ = 0;

  // of next() alone: bytes of the newest frame, of either kind
  std::map<StreamKind, std::pair<std::uint32_t, std::shared_ptr<const std::string>>> bytes_;
  std::thread thread_;
};

}  // namespace supple
