#include <io/text/cursor.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace supple {
namespace {

std::string in_quotes(std::string_view word) {
  std::string shown(word.substr(0, 40));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  return "\"" + shown + (word.size() > 40 ? "…\"" : "\"");
}

/// Where the number in a word begins: std::from_chars takes no '+'.
const char* without_plus(std::string_view word) {
  return word.data() + (word.starts_with('+') && !word.starts_with("+-"));
}

}  // namespace

std::string read_bytes(const std::filesystem::path& path) {
  const auto fail = [&] { throw InputError(path.string() + ": cannot be read: " + std::strerror(errno)); };
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw InputError(path.string() + ": is a folder, expected a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) fail();
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  std::string bytes(unknown ? 0 : size, '\0');
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  std::array<char, 1 << 14> more;  // pipes have no size
  while (const std::size_t n = std::fread(more.data(), 1, more.size(), file.get())) bytes.append(more.data(), n);
  if (std::ferror(file.get())) fail();
  return bytes;
}

std::string read_text(const std::filesystem::path& path) {
  std::string bytes = read_bytes(path);
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.erase(0, 3);
  return bytes;
}

std::size_t Cursor::continuation() const {
  if (syntax_.continuation == '\0' || bytes_[position_] != syntax_.continuation) return 0;
  const std::string_view rest = bytes_.substr(position_ + 1, 2);
  return rest.starts_with('\n') ? 2 : rest == "\r\n" ? 3 : 0;
}

void Cursor::skip_blanks(bool over_lines) {
  while (position_ < bytes_.size()) {
    const char c = bytes_[position_];
    if (c == '\n' && !over_lines) return;
    if (const std::size_t mark = continuation())
      position_ += mark;
    else if (is_blank(c))
      ++position_;
    else if (c == syntax_.comment && c != '\0')
      position_ = std::min(bytes_.find('\n', position_), bytes_.size());
    else
      return;
  }
}

std::string_view Cursor::word() {
  skip_blanks(/*over_lines=*/true);
  return word_in_line();
}

std::string_view Cursor::word_in_line() {
  skip_blanks(/*over_lines=*/false);
  word_ = position_;
  while (position_ < bytes_.size() && !is_blank(bytes_[position_]) &&
         (bytes_[position_] != syntax_.comment || syntax_.comment == '\0') && continuation() == 0)
    ++position_;
  return bytes_.substr(word_, position_ - word_);
}

bool Cursor::at_line_end() {
  skip_blanks(/*over_lines=*/false);
  return position_ == bytes_.size() || bytes_[position_] == '\n';
}

std::string_view Cursor::peek() {
  const std::size_t position = position_, last = word_;
  const std::string_view next = word();
  position_ = position, word_ = last;
  return next;
}

std::string_view Cursor::rest_of_line() {
  word_ = position_;
  const std::size_t end = std::min(bytes_.find('\n', position_), bytes_.size());
  std::string_view line = bytes_.substr(position_, end - position_);
  position_ = std::min(end + 1, bytes_.size());
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::int64_t Cursor::integer(std::string_view what) {
  return to_integer(word(), what);
}
double Cursor::real(std::string_view what) {
  return to_real(word(), what);
}
std::int64_t Cursor::integer_in_line(std::string_view what) {
  return to_integer(word_in_line(), what);
}
double Cursor::real_in_line(std::string_view what) {
  return to_real(word_in_line(), what);
}

std::int64_t Cursor::to_integer(std::string_view word, std::string_view what) const {
  std::int64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(without_plus(word), end, value);
  if (error != std::errc() || rest != end) fail_expecting(what, word);
  return value;
}

double Cursor::to_real(std::string_view word, std::string_view what) const {
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(without_plus(word), end, value);
  if (error == std::errc::result_out_of_range && rest == end)  // 1e-400 is zero, 1e400 infinite
    return std::strtod(std::string(word).c_str(), nullptr);
  if (error != std::errc() || rest != end) fail_expecting(what, word);
  return value;
}

void Cursor::expect(std::string_view expected) {
  const std::string_view found = word();
  if (found != expected) fail_expecting(expected, found);
}

Index Cursor::count(std::string_view what, std::size_t size) {
  const std::int64_t count = integer("the number of " + std::string(what));
  if (count < 0) fail("the number of " + std::string(what) + " is negative");
  expect_room(static_cast<std::uint64_t>(count), size, what);
  return count;
}

bool Cursor::skip_behind(std::string_view word, Where where) {
  for (std::size_t at = bytes_.find(word, position_); at != std::string_view::npos; at = bytes_.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((where == Where::Anywhere || at == 0 || bytes_[at - 1] == '\n') &&
        (end == bytes_.size() || is_blank(bytes_[end]))) {
      word_ = at, position_ = end;
      return true;
    }
  }
  return false;
}

void Cursor::expect_room(std::uint64_t count, std::size_t size, std::string_view what) const {
  if (size == 0 || count <= num_left() / size) return;
  fail("announces " + std::to_string(count) + " " + std::string(what) + ", but the " + std::to_string(num_left()) +
       " bytes that follow cannot hold them");
}

void Cursor::fail(const std::string& message) const {
  if (binary_) throw InputError(name_ + ", byte " + std::to_string(word_) + ": " + message);
  const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(word_), '\n');
  throw InputError(name_ + ":" + std::to_string(line) + ": " + message);
}

void Cursor::fail_whole(const std::string& message) const {
  throw InputError(name_ + ": " + message);
}

void Cursor::fail_expecting(std::string_view what, std::string_view found) const {
  const std::string where = position_ >= bytes_.size() ? "the file ends" : "the line ends";
  fail("expected " + std::string(what) + ", " + (found.empty() ? where : "found " + in_quotes(found)));
}

}  // namespace supple
