#include <app/pose_file.hpp>
#include <core/check.hpp>
#include <core/tensor_file.hpp>
#include <io/matrix_file.hpp>

namespace supple {

namespace {

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
  const Matrix all = is_matrix_file(path) ? read_matrix(path) : read_tensors(path);
  if (!all.allFinite()) throw InputError(path.string() + ": a pose is not finite");
  std::vector<Index> deformed;  // at rest there is no force to fit
  for (Index t = 0; t < all.cols(); ++t)
    if (!all.col(t).isZero(0)) deformed.push_back(t);
  if (deformed.empty()) throw InputError(path.string() + ": there are no poses");
  return all(Eigen::all, deformed);
}

}  // namespace supple
