#pragma once
/// \file Damages files at random, and watches how much memory is asked for: for the tests that feed readers
/// what no writer would write. A program that links damage.cpp has its operator new.

#include <core/random.hpp>

#include <cstddef>
#include <string>

namespace supple::test {

/// One to three random changes: bits, bytes, numbers, missing, repeated and exchanged pieces.
std::string damaged(std::string bytes, Random& random);

/// The largest single request to operator new since forget_requests.
std::size_t largest_request();
void forget_requests();

}  // namespace supple::test
