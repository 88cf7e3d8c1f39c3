#include <core/parallel.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace supple {
namespace {

struct Parallel : testing::TestWithParam<int> {
  Parallel() { set_num_threads(GetParam()); }
  ~Parallel() override { set_num_threads(0); }
};
INSTANTIATE_TEST_SUITE_P(Threads, Parallel, testing::Values(1, 2, 7), testing::PrintToStringParamName());

TEST_P(Parallel, CallsEachPieceOnce) {
  std::vector<std::atomic<int>> calls(1000);
  parallel_for(1000, [&](Index k) { ++calls[k]; });
  for (const auto& count : calls) EXPECT_EQ(count, 1);
  parallel_for(0, [](Index) { FAIL(); });
}

TEST_P(Parallel, UsesNoMoreThreadsThanAsked) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  parallel_for(200, [&](Index) {
    std::this_thread::yield();
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
  });
  EXPECT_LE(static_cast<int>(threads.size()), GetParam());
}

TEST_P(Parallel, RangesCoverEverythingOnceAndKeepToTheGrain) {
  for (const Index count : {0, 1, 16, 17, 100}) {
    std::vector<std::atomic<int>> calls(count);
    parallel_ranges(count, 16, [&](Index begin, Index end) {
      EXPECT_LE(end - begin, 16);
      EXPECT_EQ(begin % 16, 0);
      for (Index k = begin; k < end; ++k) ++calls[k];
    });
    for (const auto& touched : calls) EXPECT_EQ(touched, 1);
  }
}

TEST_P(Parallel, RethrowsAnExceptionAndCanGoOn) {
  EXPECT_THROW(parallel_for(100,
                            [](Index k) {
                              if (k == 41) throw std::runtime_error("41");
                            }),
               std::runtime_error);
  std::atomic<int> calls = 0;
  parallel_for(100, [&](Index) { ++calls; });
  EXPECT_EQ(calls, 100);
}

TEST_P(Parallel, NestedLoopsRunSerially) {
  std::vector<Index> sums(8, 0);
  parallel_for(8, [&](Index outer) {
    const std::thread::id self = std::this_thread::get_id();
    parallel_for(100, [&](Index inner) {
      EXPECT_TRUE(GetParam() == 1 || std::this_thread::get_id() == self);
      sums[outer] += inner;  // not atomic: only safe because the loop is serial
    });
  });
  for (const Index sum : sums) EXPECT_EQ(sum, 4950);
}

TEST(NumThreads, IsWhatWasSetAndNeverNegative) {
  set_num_threads(3);
  EXPECT_EQ(num_threads(), 3);
  EXPECT_THROW(set_num_threads(-1), std::invalid_argument);
  set_num_threads(0);
  EXPECT_GE(num_threads(), 1);
}

}  // namespace
}  // namespace supple
