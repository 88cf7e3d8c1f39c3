#pragma once
/// \file Cursor through a file held in memory, as text or as binary numbers; every error names the file and the place.

#include <core/check.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace supple {

/// The whole content of a file. \throws InputError if it cannot be read.
std::string read_bytes(const std::filesystem::path& path);

/// The same of a text: without the byte order mark that some programs put before UTF-8.
std::string read_text(const std::filesystem::path& path);

/// Reads words and numbers of a text, or numbers of fixed size of a binary file, in turn. Nothing is
/// allocated for what a file announces before expect_room has seen that the file can hold it. The bytes must
/// outlive the cursor.
class Cursor {
 public:
  /// What separates words besides white space, what begins a comment up to the end of its line, and what has a line go on in
  /// the next when it is its last character.
  struct Syntax {
    char separator = '\0', comment = '\0', continuation = '\0';  // '\0': nothing does
  };

  Cursor(std::string name, std::string_view bytes) : Cursor(std::move(name), bytes, Syntax{}) {}
  Cursor(std::string name, std::string_view bytes, Syntax syntax)
      : name_(std::move(name)), bytes_(bytes), syntax_(syntax) {}

  const std::string& name() const { return name_; }
  std::string_view bytes() const { return bytes_; }
  std::size_t position() const { return position_; }
  void set_position(std::size_t position) { word_ = position_ = position; }
  std::size_t num_left() const { return bytes_.size() - position_; }

  // Text.
  std::string_view word();          ///< the next one, over line ends; empty at the end
  std::string_view word_in_line();  ///< the next one of the current line; empty at its end
  bool at_line_end();               ///< no word is left in the current line
  std::string_view peek();          ///< the next word, without leaving the place
  std::string_view rest_of_line();  ///< without its end; goes to the next line
  std::int64_t integer(std::string_view what);
  double real(std::string_view what);
  /// The numbers that stand in one line.
  std::int64_t integer_in_line(std::string_view what);
  double real_in_line(std::string_view what);
  /// The next word must be this one.
  void expect(std::string_view word);
  /// A count ≥ 0 of things that take at least `size` bytes each in what follows.
  Index count(std::string_view what, std::size_t size);
  enum class Where { Anywhere, LineStart };
  /// Goes behind the next occurrence of the word. False and unmoved if there is none.
  bool skip_behind(std::string_view word, Where where);

  // Binary.
  void set_binary(std::endian order) { binary_ = true, swap_ = order != std::endian::native; }
  void set_text() { binary_ = false; }
  bool is_binary() const { return binary_; }
  template <typename Number>
  Number take(std::string_view what) {
    word_ = position_;
    if (num_left() < sizeof(Number)) fail("the file ends inside " + std::string(what));
    std::array<char, sizeof(Number)> raw;
    std::memcpy(raw.data(), bytes_.data() + position_, raw.size());
    position_ += raw.size();
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }

  /// \throws InputError if `count` things of at least `size` bytes each cannot follow.
  void expect_room(std::uint64_t count, std::size_t size, std::string_view what) const;
  /// \throws InputError "name:line: message" or "name, byte n: message", where the last word or number began.
  [[noreturn]] void fail(const std::string& message) const;
  /// \throws InputError "name: message".
  [[noreturn]] void fail_whole(const std::string& message) const;

 private:
  void skip_blanks(bool over_lines);
  /// Length of a mark here that the line goes on, with the line's end; 0: there is none.
  std::size_t continuation() const;
  bool is_blank(char c) const { return static_cast<unsigned char>(c) <= ' ' || (c == syntax_.separator && c != '\0'); }
  std::int64_t to_integer(std::string_view word, std::string_view what) const;
  double to_real(std::string_view word, std::string_view what) const;
  [[noreturn]] void fail_expecting(std::string_view what, std::string_view found) const;

  std::string name_;
  std::string_view bytes_;
  Syntax syntax_;
  std::size_t position_ = 0, word_ = 0;  // the next byte; where the last word or number began
  bool binary_ = false, swap_ = false;
};

}  // namespace supple
