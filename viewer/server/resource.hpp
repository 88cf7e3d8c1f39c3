#pragma once
/// \file Resources that a server hands out by name: the page's files and the arrays of a model.

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace supple {

struct ViewModel;

/// Bytes and what they are.
struct Resource {
  std::string type;  ///< MIME
  std::string bytes;
};

/// By exact path, "/assets/page.js".
using Resources = std::map<std::string, Resource, std::less<>>;

/// The files of a page in a folder, read now, so that no request ever names one; "/" is its index.html. Links that lead
/// elsewhere are left out. \throws InputError for a folder that cannot be read, has no index.html, or more than 64 MiB.
Resources read_page(const std::filesystem::path& folder);

/// What docs/viewer-protocol.md lists below /model.
Resources model_resources(const ViewModel& model);

}  // namespace supple
