#include <app/report/terminal.hpp>
#include <core/stopwatch.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <unistd.h>

namespace supple {

namespace {

std::atomic<bool> line_is_shown = false;

}  // namespace

Progress progress_bar() {
  if (!isatty(STDERR_FILENO)) return {};
  return [stage_shown = std::string(), watch = Stopwatch()](std::string_view stage, double share) mutable {
    constexpr int width = 32;
    if (stage == stage_shown && watch.seconds() < 0.05) return;
    stage_shown = stage;
    watch.restart();
    const double safe = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0;
    std::string bar(width, ' ');
    std::fill_n(bar.begin(), static_cast<int>(safe * width), '=');
    std::fprintf(stderr, "\r%-20.*s [%s] %3.0f %%\033[K", static_cast<int>(stage.size()), stage.data(), bar.c_str(),
                 100 * safe);
    line_is_shown = true;
  };
}

void clear_progress() {
  if (line_is_shown.exchange(false)) std::fputs("\r\033[K", stderr);
}

void warn(std::string_view message) {
  clear_progress();
  std::fprintf(stderr, "supple: warning: %.*s\n", static_cast<int>(message.size()), message.data());
}

void print_rows(std::FILE* out, std::string_view title, const Rows& rows) {
  clear_progress();
  std::fprintf(out, "%.*s\n", static_cast<int>(title.size()), title.data());
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, row.first.size());
  for (const auto& [name, value] : rows)
    std::fprintf(out, "  %-*s  %s\n", static_cast<int>(width), name.c_str(), value.c_str());
}

void print_stages(std::FILE* out, const std::vector<std::pair<std::string, double>>& seconds, double total) {
  clear_progress();
  double rest = total;
  std::size_t width = 5;
  for (const auto& stage : seconds) width = std::max(width, stage.first.size());
  const auto print = [&](const std::string& name, double time) {
    std::fprintf(out, "  %-*s %9.3f s\n", static_cast<int>(width), name.c_str(), time);
  };
  std::fputs("time\n", out);
  for (const auto& [name, time] : seconds) {
    print(name, time);
    rest -= time;
  }
  if (rest >= 0.0005) print("other", rest);
  print("total", total);
}

std::string shown_percent(double share, int digits) {
  return std::isnan(share) ? "not measured" : shown(100 * share, digits) + " %";
}

std::string shown_count(long long count) {
  std::string text = std::to_string(count);
  for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0 && text[at - 1] != '-'; at -= 3)
    text.insert(at, 1, ' ');
  return text;
}

std::string shown_iterations(long long count) {
  return shown_count(count) + (count == 1 ? " iteration" : " iterations");
}

std::string shown_bytes(double bytes) {
  return bytes < 1e9 ? shown(bytes / 1e6, 3) + " MB" : shown(bytes / 1e9, 3) + " GB";
}

}  // namespace supple
