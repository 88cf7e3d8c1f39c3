#pragma once
/// \file Version of the library; CMake reads it from here, too.

#define SUPPLE_VERSION "0.1.0"
