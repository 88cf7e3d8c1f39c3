#pragma once
/// \file Memory that the process has taken so far.

namespace supple {

/// Resident memory of the process: the largest so far [bytes]; 0 where the system does not tell.
double peak_resident_memory();

}  // namespace supple
