#pragma once
/// \file Mutex around METIS ordering. Private.

#include <mutex>

namespace supple {

/// METIS draws from the C library's generator, which it seeds first: one caller at a time gets the same ordering.
inline std::mutex metis_mutex;

}  // namespace supple
