#pragma once
/// \file Reader of matrices and vectors from other programs: NumPy's .npy and Matrix Market's .mtx.

#include <core/types.hpp>

#include <filesystem>

namespace supple {

/// A dense matrix from a file of either kind, which its first bytes tell, not its name:
/// - NumPy, format versions 1 to 3: rank 2, real numbers of 4 or 8 bytes or whole ones of 1 to 8, in either
///   byte order, rows or columns first. Whole numbers beyond 2⁵³ are rounded.
/// - Matrix Market: array or coordinate; real, integer or pattern (ones); general, symmetric or
///   skew-symmetric. Entries that a coordinate file states twice are added. As the matrix becomes dense, one
///   of more than a million entries must state at least a thousandth of them.
///
/// A pipe serves, too. Nothing is allocated for what a header announces before the file is seen to be long
/// enough for it.
/// \return rows × cols, both at least 1, all entries finite.
/// \throws InputError naming the file, the byte or line, and what was expected; an entry that is not finite
/// by its row and column, counted from 0.
/// \note a .npy file is read in one pass, in pieces of a few MB (16 rows at least) beside the matrix; a .mtx
/// file is in memory as a whole while it is read.
Matrix read_matrix(const std::filesystem::path& path);

/// A vector from the same files: .npy of shape (n,), (n, 1) or (1, n); .mtx of n × 1 or 1 × n.
/// \throws InputError as above.
Vector read_vector(const std::filesystem::path& path);

/// Whether a file can be read and begins as one of these does.
bool is_matrix_file(const std::filesystem::path& path);

}  // namespace supple
