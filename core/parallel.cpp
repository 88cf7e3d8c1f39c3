#include <core/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace supple {

namespace {
std::atomic<int> requested_threads{0};
thread_local bool inside_parallel_for = false;
}  // namespace

void set_num_threads(int threads) {
  if (threads < 0)
    throw std::invalid_argument("number of threads is " + std::to_string(threads) + ", expected 0 or more");
  requested_threads = threads;
}

int num_threads() {
  const int requested = requested_threads;
  return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(Index count, const std::function<void(Index)>& piece) {
  const Index threads = std::min<Index>(num_threads(), count);
  if (threads <= 1 || inside_parallel_for) {
    for (Index k = 0; k < count; ++k) piece(k);
    return;
  }
  std::atomic<Index> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    inside_parallel_for = true;
    try {
      for (Index k = next++; k < count; k = next++) piece(k);
    } catch (...) {
      next = count;
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
    inside_parallel_for = false;
  };
  {
    std::vector<std::jthread> helpers;
    for (Index t = 1; t < threads; ++t) helpers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace supple
