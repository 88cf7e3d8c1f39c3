#include <core/check.hpp>
#include <core/checkpoint.hpp>
#include <core/version.hpp>

namespace supple {

Digest Checkpoint::start(const std::string& stage) {
  Digest digest;
  digest.add(stage).add(SUPPLE_VERSION);
  return digest;
}

void Checkpoint::make_folder() const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error || !std::filesystem::is_directory(folder_, error))
    throw InputError(folder_.string() + ": cannot be made a folder: " + error.message());
}

}  // namespace supple
