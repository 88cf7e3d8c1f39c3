#pragma once
/// \file Tables of text in Markdown and HTML, and pages that need no other file.

#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// Rows of cells under a heading. The first column holds words, the others numbers.
struct TextTable {
  std::vector<std::string> heading;
  std::vector<std::vector<std::string>> rows;
};

std::string markdown(const TextTable& table);
std::string html(const TextTable& table);

/// A text whose characters mean nothing to HTML.
std::string escaped(std::string_view text);
/// A picture and what is below it. \param picture  HTML: an <svg> or what embedded_png() gives.
std::string figure(std::string_view picture, std::string_view caption);
/// The bytes of a PNG file as an element of a page.
std::string embedded_png(std::string_view bytes, std::string_view description);
/// A whole page. \param body  HTML below the heading and the description.
std::string page(std::string_view title, std::string_view description, std::string_view body);

}  // namespace supple
