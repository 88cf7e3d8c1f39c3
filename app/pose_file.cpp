#include <app/pose_file.hpp>
#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/tensor_file.hpp>

#include <charconv>
#include <cstring>

namespace supple {

namespace {

constexpr std::string_view npy_magic = "\x93NUMPY";

template <typename Real, int order>
Matrix to_matrix(const char* bytes, Index rows, Index cols) {
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, order> matrix(rows, cols);
  std::memcpy(matrix.data(), bytes, sizeof(Real) * static_cast<std::size_t>(matrix.size()));
  return matrix.template cast<double>();
}

/// NumPy Enhancement Proposal 1: magic, version, length of the header, header (a Python dict), data.
Matrix read_npy(const std::filesystem::path& path, const std::string& bytes) {
  const auto refuse = [&](const std::string& why) { return InputError(path.string() + ": " + why); };
  const std::size_t length_size = bytes.size() > 6 && bytes[6] == 1 ? 2 : 4, start = 8 + length_size;
  if (bytes.size() < start) throw refuse("the file ends in its header");
  std::size_t length = 0;
  for (std::size_t k = length_size; k-- > 0;) length = length << 8 | static_cast<unsigned char>(bytes[8 + k]);
  if (length > bytes.size() - start) throw refuse("the file ends in its header");
  const std::string_view header(bytes.data() + start, length);
  const auto after = [&](std::string_view key) {
    const std::size_t at = header.find(key);
    if (at == std::string_view::npos) throw refuse("the header has no " + std::string(key));
    return header.substr(header.find_first_not_of(" ", at + key.size()));
  };
  const std::string_view type = after("'descr':"), shape = after("'shape':");
  const bool single = type.starts_with("'<f4'"),
             columns_first = after("'fortran_order':").starts_with("True");
  if (!single && !type.starts_with("'<f8'"))
    throw refuse("the numbers are of type " + std::string(type.substr(0, 5)) + ", expected '<f8' or '<f4'");
  Index size[2] = {0, 0};
  const char* at = shape.data() + 1;
  const char* const end = header.data() + header.size();
  for (Index& extent : size) {
    while (at < end && (*at == ' ' || *at == ',')) ++at;
    const auto [rest, error] = std::from_chars(at, end, extent);
    if (error != std::errc() || extent < 1) throw refuse("expected an array of rank 2, rows x poses");
    at = rest;
  }
  while (at < end && (*at == ' ' || *at == ',')) ++at;
  if (at == end || *at != ')') throw refuse("expected an array of rank 2, rows x poses");
  const std::size_t available = (bytes.size() - start - length) / (single ? 4 : 8);
  if (static_cast<std::size_t>(size[1]) > available ||
      static_cast<std::size_t>(size[0]) > available / size[1])
    throw refuse("the file ends before its " + std::to_string(size[0]) + " x " + std::to_string(size[1]) +
                 " numbers");
  const char* const data = bytes.data() + start + length;
  if (columns_first)
    return single ? to_matrix<float, Eigen::ColMajor>(data, size[0], size[1])
                  : to_matrix<double, Eigen::ColMajor>(data, size[0], size[1]);
  return single ? to_matrix<float, Eigen::RowMajor>(data, size[0], size[1])
                : to_matrix<double, Eigen::RowMajor>(data, size[0], size[1]);
}

Matrix read_tensors(const std::filesystem::path& path) {
  const TensorFile file(path);
  if (file.contains("poses")) return file.matrix("poses");
  if (file.contains("q")) return file.matrix("q").transpose();
  if (file.contains("displacement")) {
    const std::vector<Index>& shape = file.shape("displacement");
    const auto u = file.values<float>("displacement", {TensorFile::any, TensorFile::any, 3});
    return Eigen::Map<const Eigen::MatrixXf>(u.data(), 3 * shape[1], shape[0]).cast<double>();
  }
  throw InputError(path.string() + ": there is no array 'poses', nor 'q' or 'displacement' of a trajectory");
}

}  // namespace

Matrix read_poses(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const Matrix all = bytes.starts_with(npy_magic) ? read_npy(path, bytes) : read_tensors(path);
  if (!all.allFinite()) throw InputError(path.string() + ": a pose is not finite");
  std::vector<Index> deformed;  // at rest there is no force to fit
  for (Index t = 0; t < all.cols(); ++t)
    if (!all.col(t).isZero(0)) deformed.push_back(t);
  if (deformed.empty()) throw InputError(path.string() + ": there are no poses");
  return all(Eigen::all, deformed);
}

}  // namespace supple
