#pragma once
/// \file Guard that holds BLAS to one thread for a while. Private.

#include <dlfcn.h>
#include <mutex>

namespace supple {

/// Keeps OpenBLAS on one thread while at least one guard lives: the way it splits a product over threads
/// changes the bits of the result. Any other BLAS is left alone.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas() {
    const std::lock_guard lock(mutex_);
    if (guards_++ > 0 || !set_threads()) return;
    threads_before_ = get_threads()();
    if (threads_before_ != 1) set_threads()(1);
  }
  ~SingleThreadedBlas() {
    const std::lock_guard lock(mutex_);
    if (--guards_ == 0 && set_threads() && threads_before_ != 1) set_threads()(threads_before_);
  }
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  // Looked up at run time, because any BLAS may stand behind the system's libblas.
  static auto set_threads() -> void (*)(int) {
    static const auto function = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    return function;
  }
  static auto get_threads() -> int (*)() {
    static const auto function = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
    return function;
  }

  static inline std::mutex mutex_;
  static inline int guards_ = 0;
  static inline int threads_before_ = 1;
};

}  // namespace supple
