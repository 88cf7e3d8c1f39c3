#pragma once
/// \file Folder in which long stages keep what they made, so that what was stopped goes on from there.

#include <core/digest.hpp>
#include <core/tensor_file.hpp>

#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>

namespace supple {

/// Keeps results of stages by what they are made from: the same inputs give the same bits again, from a file of the folder
/// instead of by work. Jobs may share a folder, one after another or at once; files that none needs may be removed.
///
/// A result is written and read by two functions beside its type, store(TensorFileWriter&, const T&) and
/// restore(const TensorFile&, T&).
class Checkpoint {
 public:
  Checkpoint() = default;  ///< keeps nothing
  explicit Checkpoint(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool keeps() const { return !folder_.empty(); }
  const std::filesystem::path& folder() const { return folder_; }
  /// \throws InputError if there is no such folder and none can be made.
  void make_folder() const;

  /// What the stage made of these inputs before, or else what make() returns, which is then kept.
  /// \param inputs  inputs(digest) adds all that the result depends on; not called if nothing is kept.
  /// \throws InputError naming the file, if one cannot be written or is damaged; what make() throws.
  template <typename Inputs, typename Make>
  std::decay_t<std::invoke_result_t<Make>> keep(const std::string& stage, const Inputs& inputs, Make&& make) const {
    if (!keeps()) return make();
    Digest digest = start(stage);
    inputs(digest);
    const std::filesystem::path path = folder_ / (stage + "-" + digest.text() + ".safetensors");
    std::decay_t<std::invoke_result_t<Make>> result;
    if (std::filesystem::exists(path)) {
      restore(TensorFile(path), result);
      return result;
    }
    result = make();
    TensorFileWriter file;
    store(file, result);
    make_folder();
    file.write(path);
    return result;
  }

 private:
  static Digest start(const std::string& stage);  // of stage and program

  std::filesystem::path folder_;
};

}  // namespace supple
