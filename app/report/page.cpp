#include <app/report/page.hpp>

#include <algorithm>
#include <cstdint>

namespace supple {

namespace {

constexpr std::string_view page_style =
    R"(body { font: 15px/1.5 system-ui, sans-serif; max-width: 64rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
figure { margin: 2rem 0; } figcaption { color: #555; } svg, img { max-width: 100%; height: auto; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
)";

/// RFC 4648.
std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

std::string markdown(const TextTable& table) {
  const auto line = [](const std::vector<std::string>& texts) {
    std::string result = "|";
    for (const std::string& text : texts) result += " " + text + " |";
    return result + "\n";
  };
  std::vector<std::string> rule(table.heading.size(), "---:");
  rule.front() = "---";
  std::string result = line(table.heading) + line(rule);
  for (const auto& row : table.rows) result += line(row);
  return result;
}

std::string html(const TextTable& table) {
  const auto line = [](const std::vector<std::string>& texts, const std::string& tag) {
    std::string result = "<tr>";
    for (const std::string& text : texts) result += "<" + tag + ">" + escaped(text) + "</" + tag + ">";
    return result + "</tr>\n";
  };
  std::string result = "<div class=\"wide\">\n<table>\n<thead>" + line(table.heading, "th") + "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) result += line(row, "td");
  return result + "</tbody>\n</table>\n</div>\n";
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

std::string figure(std::string_view picture, std::string_view caption) {
  return "<figure>\n" + std::string(picture) + "<figcaption>" + escaped(caption) + "</figcaption>\n</figure>\n";
}

std::string embedded_png(std::string_view bytes, std::string_view description) {
  return "<img alt=\"" + escaped(description) + "\" src=\"data:image/png;base64," + base64(bytes) + "\">\n";
}

std::string page(std::string_view title, std::string_view description, std::string_view body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + escaped(title) +
         "</title>\n<style>\n" + std::string(page_style) + "</style>\n</head>\n<body>\n<h1>" + escaped(title) +
         "</h1>\n<p>" + escaped(description) + "</p>\n" + std::string(body) + "</body>\n</html>\n";
}

}  // namespace supple
