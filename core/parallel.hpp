#pragma once
/// \file Parallel loops over independent pieces of work. Results never depend on the number of threads: the pieces are
/// fixed by the caller, and only which thread computes a piece varies.

#include <core/types.hpp>

#include <functional>

namespace supple {

/// Number of threads that parallel_for uses from now on; 0: one for each processor. \throws
/// std::invalid_argument if negative.
void set_num_threads(int threads);
int num_threads();

/// Calls piece(k) for k = 0 … count − 1, each exactly once, from up to num_threads() threads; returns when
/// all are done. Inside a piece, a further parallel_for runs serially. An exception of a piece is rethrown
/// here once all threads have stopped.
void parallel_for(Index count, const std::function<void(Index)>& piece);

/// Calls body(begin, end) on consecutive ranges of at most `grain` of 0 … count − 1.
template <typename Body>
void parallel_ranges(Index count, Index grain, const Body& body) {
  parallel_for((count + grain - 1) / grain, [&](Index k) { body(k * grain, std::min(count, (k + 1) * grain)); });
}

}  // namespace supple
