#include <core/check.hpp>
#include <core/parallel.hpp>
#include <io/table/matrix_file.hpp>
#include <io/text/cursor.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

namespace supple {
namespace {

constexpr std::string_view npy_magic = "\x93NUMPY", mtx_magic = "%%matr";

/// What a file held. A vector has one column and rank 1.
struct Array {
  Matrix values;
  int rank = 2;
};

std::string shown_size(Index rows, Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

/// The bytes of a file in turn, of known number. What has no size, as a pipe, is read as a whole first.
class ByteStream {
 public:
  explicit ByteStream(const std::filesystem::path& path) : name_(path.string()) {
    std::error_code unknown;
    if (std::filesystem::is_regular_file(path, unknown)) {
      size_ = std::filesystem::file_size(path, unknown);
      if (unknown) size_ = 0;
      stream_ = std::make_unique<std::ifstream>(path, std::ios::binary);
      if (!*stream_) throw InputError(name_ + ": cannot be read: " + std::strerror(errno));
    } else {
      std::string bytes = read_bytes(path);  // which also says why a path cannot be read
      size_ = bytes.size();
      stream_ = std::make_unique<std::istringstream>(std::move(bytes));
    }
  }

  const std::string& name() const { return name_; }
  std::size_t position() const { return position_; }
  std::size_t num_left() const { return size_ - position_; }
  /// \throws InputError if fewer bytes are left.
  void read(void* to, std::size_t count) {
    if (count > num_left() || !stream_->read(static_cast<char*>(to), static_cast<std::streamsize>(count)))
      throw InputError(name_ + ", byte " + std::to_string(position_) + ": the file ends early");
    position_ += count;
  }
  /// The next `count` bytes, or all that are left, behind those of `bytes`.
  void append_to(std::string& bytes, std::size_t count) {
    const std::size_t size = bytes.size();
    bytes.resize(size + std::min(count, num_left()));
    read(bytes.data() + size, bytes.size() - size);
  }

 private:
  std::string name_;
  std::unique_ptr<std::istream> stream_;
  std::size_t size_ = 0, position_ = 0;
};

// ---------------------------------------------------------------------------------------------------------------------
// NumPy: magic, version, length of the header, header, numbers.

struct NpyHeader {
  char kind = 'f';            ///< 'f': real, 'i': whole, 'u': whole and not negative
  std::size_t item_size = 8;  ///< bytes of a number
  bool swapped = false;       ///< in the byte order that is not this machine's
  bool columns_first = false;
  std::vector<Index> shape;
};

/// The header's text: a Python dictionary of three items, in any order.
class NpyHeaderText {
 public:
  /// \param begin  where the text stands in the file.
  NpyHeaderText(std::string name, std::string_view text, std::size_t begin)
      : name_(std::move(name)), text_(text), begin_(begin) {}

  NpyHeader parse() {
    NpyHeader header;
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!accept('}')) {
      const std::string_view key = quoted("'descr', 'fortran_order' or 'shape'");
      bool& is_known = key == "descr" ? has_type : key == "fortran_order" ? has_order : has_shape;
      if (&is_known == &has_shape && key != "shape") fail_at_item("expected 'descr', 'fortran_order' or 'shape'");
      if (is_known) fail_at_item("'" + std::string(key) + "' appears twice in the header");
      is_known = true;
      expect(':');
      if (key == "descr")
        parse_type(header);
      else if (key == "fortran_order")
        header.columns_first = flag();
      else
        header.shape = shape();
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    skip_blanks();
    if (at_ < text_.size()) fail("expected nothing but spaces behind the header's '}'");
    item_ = at_;
    if (!has_type || !has_order || !has_shape)
      fail_at_item(std::string("the header has no ") + (!has_type    ? "'descr'"
                                                        : !has_order ? "'fortran_order'"
                                                                     : "'shape'"));
    return header;
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
  }
  bool accept(char c) {
    skip_blanks();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail("expected '" + std::string(1, c) + "' in the header");
  }

  std::string_view quoted(const std::string& what) {
    skip_blanks();
    item_ = at_;
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    if (quote != '\'' && quote != '"') fail("expected " + what);
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == text_.npos) fail("expected a closing quotation mark in the header");
    const std::string_view inside = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return inside;
  }

  bool flag() {
    skip_blanks();
    for (const bool value : {false, true}) {
      const std::string_view word = value ? "True" : "False";
      if (!text_.substr(at_).starts_with(word)) continue;
      at_ += word.size();
      return value;
    }
    fail("'fortran_order' is neither True nor False");
  }

  void parse_type(NpyHeader& header) {
    const std::string expectation =
        "expected 'descr' to be a plain type of real or whole numbers, such as '<f8', '<f4' or '<i8'";
    const std::string_view type = quoted("'descr' as a text such as '<f8', not a structured type");
    if (type.size() != 3) fail_at_item(expectation);
    const char order = type[0];
    header.kind = type[1] == 'b' ? 'u' : type[1];  // truth values are bytes, 0 or 1
    header.item_size = static_cast<std::size_t>(type[2] - '0');
    const bool is_real = type[1] == 'f' && (type[2] == '4' || type[2] == '8'),
               is_whole = (type[1] == 'i' || type[1] == 'u') &&
                          (type[2] == '1' || type[2] == '2' || type[2] == '4' || type[2] == '8'),
               is_truth = type[1] == 'b' && type[2] == '1';
    if ((!is_real && !is_whole && !is_truth) || std::string_view("<>=|").find(order) == std::string_view::npos ||
        (order == '|' && header.item_size > 1))
      fail_at_item(expectation);
    header.swapped = order == (std::endian::native == std::endian::little ? '>' : '<');
  }

  std::vector<Index> shape() {
    std::vector<Index> extents;
    expect('(');
    item_ = at_ - 1;
    while (!accept(')')) {
      Index extent = 0;
      skip_blanks();
      const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), extent);
      if (error != std::errc() || extent < 0) fail("expected an extent of 'shape', a whole number from 0 up");
      at_ = static_cast<std::size_t>(end - text_.data());
      if (at_ < text_.size() && text_[at_] == 'L') ++at_;  // as Python 2 wrote long ones
      extents.push_back(extent);
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    if (extents.empty() || extents.size() > 2)
      fail_at_item("'shape' has " + std::to_string(extents.size()) +
                   " extents, expected 1 (a vector) or 2 (rows, columns)");
    return extents;
  }

  [[noreturn]] void fail(const std::string& message) const { fail_at(at_, message); }
  [[noreturn]] void fail_at_item(const std::string& message) const { fail_at(item_, message); }
  [[noreturn]] void fail_at(std::size_t at, const std::string& message) const {
    throw InputError(name_ + ", byte " + std::to_string(begin_ + at) + ": " + message);
  }

  std::string name_;
  std::string_view text_;
  std::size_t begin_, at_ = 0, item_ = 0;  // item_: where the last key or value began
};

NpyHeader read_npy_header(ByteStream& file) {
  const auto refuse = [&](std::size_t at, const std::string& message) {
    throw InputError(file.name() + ", byte " + std::to_string(at) + ": " + message);
  };
  std::array<unsigned char, 2> version{};
  if (file.num_left() < version.size()) refuse(file.position(), "the file ends in its header");
  file.read(version.data(), version.size());
  if (version[0] < 1 || version[0] > 3 || version[1] != 0)
    refuse(npy_magic.size(), "is of format version " + std::to_string(version[0]) + "." + std::to_string(version[1]) +
                                 ", expected 1.0, 2.0 or 3.0");
  std::array<unsigned char, 4> digits{};
  const std::size_t length_size = version[0] == 1 ? 2 : 4;
  if (file.num_left() < length_size) refuse(file.position(), "the file ends in its header");
  file.read(digits.data(), length_size);
  std::size_t length = 0;
  for (std::size_t k = length_size; k-- > 0;) length = length << 8 | digits[k];
  constexpr std::size_t longest = 1 << 16;  // of three short items and padding
  if (length > std::min(longest, file.num_left()))
    refuse(npy_magic.size() + version.size(),
           "announces a header of " + std::to_string(length) + " bytes" +
               (length > file.num_left() ? ", but the file ends before that"
                                         : ", expected at most " + std::to_string(longest)));
  const std::size_t begin = file.position();
  std::string text;
  file.append_to(text, length);
  return NpyHeaderText(file.name(), text, begin).parse();
}

constexpr Index piece_size = Index{1} << 20;  // numbers to read at a time

template <typename Number>
void read_numbers(ByteStream& file, std::vector<Number>& numbers, Index count, bool swapped) {
  numbers.resize(static_cast<std::size_t>(count));
  file.read(numbers.data(), numbers.size() * sizeof(Number));
  if (swapped)
    for (Number& number : numbers) {
      auto* const bytes = reinterpret_cast<unsigned char*>(&number);
      std::reverse(bytes, bytes + sizeof(Number));
    }
}

template <typename Number>
void read_columns_first(ByteStream& file, bool swapped, Matrix& A) {
  if (std::is_same_v<Number, double> && !swapped) {
    file.read(A.data(), static_cast<std::size_t>(A.size()) * sizeof(double));
    return;
  }
  std::vector<Number> numbers;
  for (Index begin = 0; begin < A.size(); begin += piece_size) {
    read_numbers(file, numbers, std::min(piece_size, A.size() - begin), swapped);
    std::transform(numbers.begin(), numbers.end(), A.data() + begin,
                   [](Number number) { return static_cast<double>(number); });
  }
}

/// Transposes bands of rows in tiles that fit the nearest cache.
template <typename Number>
void read_rows_first(ByteStream& file, bool swapped, Matrix& A) {
  constexpr Index tile = 16;
  const Index rows = A.rows(), cols = A.cols();
  const Index band = std::clamp<Index>(piece_size / cols, std::min(tile, rows), rows);
  std::vector<Number> numbers;
  for (Index top = 0; top < rows; top += band) {
    const Index height = std::min(band, rows - top);
    read_numbers(file, numbers, height * cols, swapped);
    parallel_ranges(cols, tile, [&](Index left, Index right) {
      for (Index i_tile = 0; i_tile < height; i_tile += tile)
        for (Index j = left; j < right; ++j)
          for (Index i = i_tile; i < std::min(i_tile + tile, height); ++i)
            A(top + i, j) = static_cast<double>(numbers[static_cast<std::size_t>(i * cols + j)]);
    });
  }
}

template <typename Number>
void read_npy_numbers(ByteStream& file, const NpyHeader& header, Matrix& A) {
  if (header.columns_first || A.rows() == 1 || A.cols() == 1)
    read_columns_first<Number>(file, header.swapped, A);
  else
    read_rows_first<Number>(file, header.swapped, A);
}

/// Behind the magic.
Array read_npy(ByteStream& file) {
  const NpyHeader header = read_npy_header(file);
  const auto refuse = [&](const std::string& message) {
    throw InputError(file.name() + ", byte " + std::to_string(file.position()) + ": " + message);
  };
  Array array;
  array.rank = static_cast<int>(header.shape.size());
  const Index rows = header.shape[0], cols = array.rank == 2 ? header.shape[1] : 1;
  const std::string numbers = (array.rank == 2 ? shown_size(rows, cols) : std::to_string(rows)) + " numbers of " +
                              std::to_string(header.item_size) + " bytes";
  if (rows == 0 || cols == 0) refuse("the header announces " + numbers + ", expected at least one");
  const Index available = static_cast<Index>(file.num_left() / header.item_size);
  if (cols > available || rows > available / cols)
    refuse("the file ends before its " + numbers + ": " + std::to_string(file.num_left()) + " bytes are left");
  const std::size_t surplus = file.num_left() - static_cast<std::size_t>(rows * cols) * header.item_size;
  if (surplus > 0) refuse(std::to_string(surplus) + " bytes follow its " + numbers + ", expected none");

  Matrix& A = array.values;
  A.resize(rows, cols);
  const auto read_whole = [&]<typename Signed, typename Unsigned>(Signed, Unsigned) {
    header.kind == 'i' ? read_npy_numbers<Signed>(file, header, A) : read_npy_numbers<Unsigned>(file, header, A);
  };
  if (header.kind == 'f')
    header.item_size == 8 ? read_npy_numbers<double>(file, header, A) : read_npy_numbers<float>(file, header, A);
  else if (header.item_size == 8)
    read_whole(std::int64_t{}, std::uint64_t{});
  else if (header.item_size == 4)
    read_whole(std::int32_t{}, std::uint32_t{});
  else if (header.item_size == 2)
    read_whole(std::int16_t{}, std::uint16_t{});
  else
    read_whole(std::int8_t{}, std::uint8_t{});
  return array;
}

// ---------------------------------------------------------------------------------------------------------------------
// Matrix Market: a line that says what follows, comments, sizes, entries.

enum class Symmetry { General, Symmetric, Skew };

struct MtxHeader {
  bool is_array = false, is_pattern = false, is_integer = false;
  Symmetry symmetry = Symmetry::General;
};

std::string lower_case(std::string_view word) {
  std::string text(word);
  for (char& c : text)
    if ('A' <= c && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// The first line: %%MatrixMarket matrix FORMAT FIELD SYMMETRY.
MtxHeader read_mtx_header(Cursor& in) {
  std::vector<std::string> words;
  while (!in.at_line_end()) words.push_back(lower_case(in.word_in_line()));
  const auto check = [&](std::size_t k, std::initializer_list<const char*> known) {
    std::string expected;
    for (const char* word : known) {
      if (k < words.size() && words[k] == word) return;
      expected += (expected.empty() ? "" : " or ") + std::string(word);
    }
    in.fail("word " + std::to_string(k + 1) + " of the first line is " +
            (k < words.size() ? "\"" + words[k].substr(0, 40) + "\"" : std::string("missing")) + ", expected " +
            expected);
  };
  check(0, {"%%matrixmarket"});
  check(1, {"matrix"});
  check(2, {"array", "coordinate"});
  check(3, {"real", "integer", "pattern"});
  check(4, {"general", "symmetric", "skew-symmetric"});
  if (words.size() > 5) in.fail("the first line has more than 5 words");
  MtxHeader header;
  header.is_array = words[2] == "array";
  header.is_pattern = words[3] == "pattern";
  header.is_integer = words[3] == "integer";
  header.symmetry = words[4] == "general"     ? Symmetry::General
                    : words[4] == "symmetric" ? Symmetry::Symmetric
                                              : Symmetry::Skew;
  if (header.is_pattern && header.is_array) in.fail("an array cannot be a pattern, expected real or integer");
  if (header.is_pattern && header.symmetry == Symmetry::Skew)
    in.fail("a pattern cannot be skew-symmetric, expected general or symmetric");
  return header;
}

Array read_mtx(std::string name, std::string_view bytes) {
  Cursor first_line(name, bytes);
  const MtxHeader header = read_mtx_header(first_line);
  Cursor in(std::move(name), bytes, {.separator = '\0', .comment = '%'});
  in.rest_of_line();

  const auto extent = [&](const char* what, std::int64_t value) -> Index {
    if (value < 1)
      in.fail("the number of " + std::string(what) + " is " + std::to_string(value) + ", expected 1 or more");
    return value;
  };
  const Index rows = extent("rows", in.integer("the number of rows")),
              cols = extent("columns", in.integer_in_line("the number of columns"));
  const bool is_general = header.symmetry == Symmetry::General;
  if (!is_general && rows != cols)
    in.fail("is " + shown_size(rows, cols) + " and symmetric, expected as many rows as columns");
  const auto end_line = [&](const char* after) {
    if (in.at_line_end()) return;
    in.word_in_line();
    in.fail("expected the end of the line after " + std::string(after));
  };

  Array array;
  Matrix& A = array.values;
  const auto value = [&](bool in_line) -> double {
    if (header.is_pattern) return 1;
    const char* const what = header.is_integer ? "a whole number" : "a number";
    if (header.is_integer) return static_cast<double>(in_line ? in.integer_in_line(what) : in.integer(what));
    return in_line ? in.real_in_line(what) : in.real(what);
  };
  if (header.is_array) {
    end_line("the size");
    // each number takes two bytes, a separator and a digit
    in.expect_room(static_cast<std::uint64_t>(cols), 2, "columns");
    in.expect_room(static_cast<std::uint64_t>(rows), static_cast<std::size_t>(is_general ? 2 * cols : cols - 1),
                   "rows");
    A.setZero(rows, cols);
    for (Index j = 0; j < cols; ++j)
      for (Index i = is_general ? 0 : header.symmetry == Symmetry::Symmetric ? j : j + 1; i < rows; ++i) {
        A(i, j) = value(/*in_line=*/false);
        if (!is_general) A(j, i) = header.symmetry == Symmetry::Skew ? -A(i, j) : A(i, j);
      }
  } else {
    const std::int64_t count = in.integer_in_line("the number of entries");
    if (count < 0) in.fail("the number of entries is negative");
    end_line("the size");
    in.expect_room(static_cast<std::uint64_t>(count), header.is_pattern ? 4 : 6, "entries");
    const Index most = std::max<Index>(1'000'000, 1000 * count);
    if (cols > most || rows > most / cols)
      in.fail("a matrix of " + shown_size(rows, cols) + " with " + std::to_string(count) +
              " entries is too sparse to be kept dense, expected one in 1000 at least");
    A.setZero(rows, cols);
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t i = in.integer("a row number");
      if (i < 1 || i > rows)
        in.fail("row " + std::to_string(i) + " does not exist, expected 1 to " + std::to_string(rows));
      const std::int64_t j = in.integer_in_line("a column number");
      if (j < 1 || j > cols)
        in.fail("column " + std::to_string(j) + " does not exist, expected 1 to " + std::to_string(cols));
      if (!is_general && (j > i || (j == i && header.symmetry == Symmetry::Skew)))
        in.fail("entry (" + std::to_string(i) + ", " + std::to_string(j) +
                (j == i ? ") is on the diagonal, which is zero in a skew-symmetric matrix"
                        : ") is above the diagonal, expected each pair once, below it"));
      const double a = value(/*in_line=*/true);
      end_line("an entry");
      A(i - 1, j - 1) += a;
      if (!is_general && i != j) A(j - 1, i - 1) += header.symmetry == Symmetry::Skew ? -a : a;
    }
  }
  if (!in.peek().empty()) {
    in.word();
    in.fail("expected the end of the file after all entries");
  }
  return array;
}

Array read_array(const std::filesystem::path& path) {
  ByteStream file(path);
  std::string bytes;
  file.append_to(bytes, npy_magic.size());
  Array array;
  if (bytes == npy_magic) {
    array = read_npy(file);
  } else {
    if (lower_case(bytes) != mtx_magic)
      throw InputError(file.name() +
                       ", byte 0: expected a NumPy file (.npy) or a Matrix Market file, which begins with "
                       "%%MatrixMarket");
    file.append_to(bytes, file.num_left());
    array = read_mtx(file.name(), bytes);
  }
  const Matrix& A = array.values;
  for (Index j = 0; j < A.cols(); ++j) {
    if (A.col(j).allFinite()) continue;
    Index i = 0;
    while (std::isfinite(A(i, j))) ++i;
    throw InputError(file.name() + ": the entry in row " + std::to_string(i) + ", column " + std::to_string(j) +
                     " (from 0) is " + std::to_string(A(i, j)) + ", expected a finite number");
  }
  return array;
}

}  // namespace

Matrix read_matrix(const std::filesystem::path& path) {
  Array array = read_array(path);
  if (array.rank != 2)
    throw InputError(path.string() + ": holds a vector of " + std::to_string(array.values.rows()) +
                     " numbers, expected a matrix of rows x columns");
  return std::move(array.values);
}

Vector read_vector(const std::filesystem::path& path) {
  const Matrix values = read_array(path).values;
  if (values.rows() != 1 && values.cols() != 1)
    throw InputError(path.string() + ": holds a matrix of " + shown_size(values.rows(), values.cols()) +
                     ", expected a vector");
  return values.reshaped();
}

bool is_matrix_file(const std::filesystem::path& path) {
  std::string begin(npy_magic.size(), '\0');
  return std::ifstream(path, std::ios::binary).read(begin.data(), npy_magic.size()) &&
         (begin == npy_magic || lower_case(begin) == mtx_magic);
}

}  // namespace supple
