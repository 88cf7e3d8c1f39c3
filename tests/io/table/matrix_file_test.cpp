#include <core/check.hpp>
#include <io/table/matrix_file.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace supple::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The bytes of numbers in a byte order, one after the other.
template <typename Number, typename Values>
std::string raw(const Values& values, std::endian order = std::endian::little) {
  std::string bytes;
  for (const double value : values) {
    const auto number = static_cast<Number>(value);
    std::string one(sizeof number, '\0');
    std::memcpy(one.data(), &number, sizeof number);
    if (order != std::endian::native) std::reverse(one.begin(), one.end());
    bytes += one;
  }
  return bytes;
}

/// Magic, version, length and text of a header, padded to 64 bytes as NumPy does.
std::string npy_header(int version, std::string text) {
  const std::size_t begin = version == 1 ? 10 : 12;
  while ((begin + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  std::string bytes = "\x93NUMPY" + std::string{static_cast<char>(version), '\0'};
  for (std::size_t k = 0; k < begin - 8; ++k) bytes += static_cast<char>(text.size() >> 8 * k & 0xff);
  return bytes + text;
}

std::string npy_header(int version, const std::string& type, bool columns_first, const std::string& shape) {
  return npy_header(version, "{'descr': '" + type + "', 'fortran_order': " + (columns_first ? "True" : "False") +
                                 ", 'shape': " + shape + ", }");
}

/// A as NumPy saves it.
template <typename Number>
std::string npy(const Matrix& A, const std::string& type, bool columns_first, int version = 1) {
  const std::string shape = "(" + std::to_string(A.rows()) + ", " + std::to_string(A.cols()) + ")";
  const Vector values = columns_first ? Vector(A.reshaped()) : Vector(A.transpose().reshaped());
  return npy_header(version, type, columns_first, shape) +
         raw<Number>(values, type[0] == '>' ? std::endian::big : std::endian::little);
}

struct MatrixFile : testing::Test {
  ~MatrixFile() override { fs::remove(path); }

  const fs::path& write(const std::string& bytes) const {
    fs::remove(path);
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  Matrix matrix(const std::string& bytes) const { return read_matrix(write(bytes)); }
  Vector vector(const std::string& bytes) const { return read_vector(write(bytes)); }
  /// Demands an InputError that names the file and these words.
  void expect_refusal(const std::string& bytes, const std::string& expected) const {
    EXPECT_THAT([&] { matrix(bytes); }, ThrowsMessage<InputError>(AllOf(HasSubstr(path.string()), HasSubstr(expected))))
        << bytes.substr(0, 200);
  }

  const fs::path path = fs::temp_directory_path() / ("supple-matrix-" + std::to_string(::getpid()));
};

using NpyFile = MatrixFile;
using MtxFile = MatrixFile;

template <typename Number>
void expect_every_order_and_version(const MatrixFile& file, const std::string& type, const Matrix& A) {
  const Matrix expected = A.unaryExpr([](double a) { return static_cast<double>(static_cast<Number>(a)); });
  for (const char order : {'<', '>'})
    for (const bool columns_first : {false, true})
      for (const int version : {1, 2, 3})
        EXPECT_TRUE(is_same(file.matrix(npy<Number>(A, order + type, columns_first, version)), expected))
            << order << type << columns_first << version;
}

TEST_F(NpyFile, IsReadInEveryTypeOrderAndVersion) {
  const Matrix A = random_matrix(7, 5, 1, 3), whole = (100 * A).array().round().matrix();
  expect_every_order_and_version<double>(*this, "f8", A);
  expect_every_order_and_version<float>(*this, "f4", A);
  expect_every_order_and_version<std::int64_t>(*this, "i8", whole * 1e12);
  expect_every_order_and_version<std::int32_t>(*this, "i4", whole * 1e6);
  expect_every_order_and_version<std::int16_t>(*this, "i2", whole);
  expect_every_order_and_version<std::int8_t>(*this, "i1", whole);
  expect_every_order_and_version<std::uint64_t>(*this, "u8", whole.cwiseAbs() * 1e12);
  expect_every_order_and_version<std::uint32_t>(*this, "u4", whole.cwiseAbs() * 1e7);
  expect_every_order_and_version<std::uint16_t>(*this, "u2", whole.cwiseAbs());
  expect_every_order_and_version<std::uint8_t>(*this, "u1", whole.cwiseAbs());
  const Matrix truth = (A.array() > 0).cast<double>();
  EXPECT_TRUE(is_same(matrix(npy<std::uint8_t>(truth, "|b1", false)), truth));
  EXPECT_TRUE(is_same(matrix(npy<std::int8_t>(whole, "|i1", false)), whole));
}

TEST_F(NpyFile, KeepsEveryBitOfExtremeNumbers) {
  using Limits = std::numeric_limits<double>;
  Matrix A(2, 3);
  A << Limits::max(), Limits::denorm_min(), -0.0, Limits::lowest(), 0.1, 1e-310;
  const Matrix read = matrix(npy<double>(A, "<f8", false));
  EXPECT_TRUE(is_same(read, A));
  EXPECT_TRUE(std::signbit(read(0, 2)));
}

TEST_F(NpyFile, IsTransposedInPiecesOfAnyShape) {
  // several bands of rows, whose height is no multiple of a tile
  for (const auto& [rows, cols] : {std::pair<Index, Index>{3000, 701}, {2, 1'100'000}, {1'100'000, 2}, {37, 60'000}}) {
    const Matrix A = Matrix::NullaryExpr(
        rows, cols, [](Index i, Index j) { return static_cast<double>(i % 1009) + 1e4 * static_cast<double>(j); });
    EXPECT_EQ(matrix(npy<double>(A, "<f8", false)), A) << rows << " x " << cols;
    EXPECT_EQ(matrix(npy<float>(A, ">f4", true)), A.cast<float>().cast<double>()) << rows << " x " << cols;
  }
}

TEST_F(NpyFile, TakesVectorsAsRowsColumnsOrNeither) {
  const std::vector<double> values{1, -2, 3.5};
  for (const char* shape : {"(3,)", "(3, 1)", "(1, 3)", "(3L,)"})
    for (const bool columns_first : {false, true})
      EXPECT_THAT(vector(npy_header(1, "<f8", columns_first, shape) + raw<double>(values)),
                  testing::ElementsAre(1, -2, 3.5))
          << shape;
  EXPECT_THAT([&] { vector(npy<double>(Matrix::Ones(2, 3), "<f8", false)); },
              ThrowsMessage<InputError>(HasSubstr("holds a matrix of 2 x 3, expected a vector")));
  expect_refusal(npy_header(1, "<f8", false, "(3,)") + raw<double>(values),
                 "holds a vector of 3 numbers, expected a matrix");
}

TEST_F(NpyFile, HasItsHeaderInAnyOrderAndSpacing) {
  const std::string numbers = raw<double>(std::vector<double>{1, 2});
  for (const char* text : {"{'shape': (1, 2), 'fortran_order': False, 'descr': '<f8'}",
                           "{\"descr\":\"<f8\",\"fortran_order\":False,\"shape\":(1,2)}",
                           " {  'descr' : '=f8' , 'fortran_order' : False , 'shape' : ( 1 , 2 , ) , } "})
    EXPECT_EQ(matrix(npy_header(1, text) + numbers), Matrix(Eigen::RowVector2d(1, 2))) << text;
}

TEST_F(NpyFile, IsRefusedByByteAndExpectation) {
  const std::string numbers = raw<double>(std::vector<double>{1, 2, 3, 4});
  const auto refuse_header = [&](const std::string& text, const std::string& expected) {
    expect_refusal(npy_header(1, text) + numbers, expected);
  };
  const auto refuse_type = [&](const std::string& type) {
    expect_refusal(npy_header(1, type, false, "(2, 2)") + numbers, ", byte 20: expected 'descr' to be");
  };
  for (const char* type :
       {"<c8", "<c16", "<f2", "<f16", "<U4", "|S8", "|O", "<M8[s]", "|V8", "f8", "|f8", "<i3", "<b8", ""})
    refuse_type(type);
  refuse_header("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2, 2)}", "not a structured type");
  refuse_header("{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 2)}", "neither True nor False");
  refuse_header("{'descr': '<f8', 'fortran_order': False}", "the header has no 'shape'");
  refuse_header("{'descr': '<f8', 'shape': (2, 2)}", "the header has no 'fortran_order'");
  refuse_header("{'fortran_order': False, 'shape': (2, 2)}", "the header has no 'descr'");
  refuse_header("{'descr': '<f8', 'descr': '<f8'}", "'descr' appears twice");
  refuse_header("{'dtype': '<f8'}", "byte 11: expected 'descr', 'fortran_order' or 'shape'");
  refuse_header("{'descr': '<f8'; }", "expected '}'");
  refuse_header("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), } 1", "expected nothing but spaces");
  refuse_header("{'descr", "expected a closing quotation mark");
  refuse_header("", "byte 64: expected '{'");
  for (const char* shape : {"()", "(1, 2, 2)"})
    expect_refusal(npy_header(1, "<f8", false, shape) + numbers, "expected 1 (a vector) or 2 (rows, columns)");
  for (const char* shape : {"(-2, 2)", "(2.0, 2)", "(a)", "(2, 2", "2", "(99999999999999999999, 1)", "(2,, 2)"})
    expect_refusal(npy_header(1, "<f8", false, shape) + numbers, ": expected ");
  for (const char* shape : {"(0,)", "(0, 4)", "(4, 0)"})
    expect_refusal(npy_header(1, "<f8", false, shape), "expected at least one");
  expect_refusal(npy_header(4, "{}"), "byte 6: is of format version 4.0, expected 1.0, 2.0 or 3.0");
  expect_refusal(npy_header(1, "<f8", false, "(2, 2)") + numbers + "x", "1 bytes follow its 2 x 2 numbers");
  expect_refusal("PK\3\4 an archive", "byte 0: expected a NumPy file (.npy) or a Matrix Market file");
  expect_refusal("", "byte 0: expected a NumPy file");
}

TEST_F(NpyFile, WithALyingHeaderIsRefusedBeforeAnythingIsAllocated) {
  for (const char* shape : {"(3, 2)", "(1000000000, 1000000000)", "(9223372036854775807, 9223372036854775807)",
                            "(9223372036854775807, 2)", "(2, 4611686018427387904)", "(9223372036854775807,)"})
    expect_refusal(npy_header(2, "<f8", false, shape) + std::string(32, '\0'), "the file ends before its");
  std::string bytes = "\x93NUMPY" + std::string("\2\0\xff\xff\xff\xff{", 7);
  expect_refusal(bytes, "announces a header of 4294967295 bytes, but the file ends before that");
  expect_refusal("\x93NUMPY" + std::string("\2\0\1\0\1\0", 6) + std::string(70000, ' '), "expected at most 65536");
}

TEST_F(MatrixFile, NamesRowAndColumnOfWhatIsNotFinite) {
  Matrix A = Matrix::Ones(3, 4);
  A(2, 1) = std::nan("");
  expect_refusal(npy<double>(A, "<f8", false),
                 "the entry in row 2, column 1 (from 0) is nan, expected a finite number");
  A(2, 1) = -infinity;
  expect_refusal(npy<float>(A, ">f4", true), "row 2, column 1 (from 0) is -inf");
  expect_refusal("%%MatrixMarket matrix array real general\n2 1\n1\n1e999\n", "row 1, column 0 (from 0) is inf");
  expect_refusal("%%MatrixMarket matrix coordinate real general\n2 2 1\n2 1 nan\n", "row 1, column 0 (from 0) is nan");
}

TEST_F(MatrixFile, ComesFromAPipeToo) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const Matrix A = random_matrix(40, 30, 1, 5);
  std::thread writer([&] { std::ofstream(path, std::ios::binary) << npy<double>(A, "<f8", false); });
  const Matrix read = read_matrix(path);
  writer.join();
  EXPECT_TRUE(is_same(read, A));
}

TEST_F(MatrixFile, ThatIsNoneIsRefused) {
  EXPECT_THAT([&] { read_matrix(path / "none"); }, ThrowsMessage<InputError>(HasSubstr("cannot be read")));
  EXPECT_THAT([&] { read_vector(fs::temp_directory_path()); }, ThrowsMessage<InputError>(HasSubstr("is a folder")));
}

TEST_F(MatrixFile, IsToldFromOthersByItsBeginning) {
  EXPECT_TRUE(is_matrix_file(write(npy<double>(Matrix::Ones(1, 1), "<f8", false))));
  EXPECT_TRUE(is_matrix_file(write("%%MatrixMarket matrix")));
  EXPECT_FALSE(is_matrix_file(write("%% notes")));
  EXPECT_FALSE(is_matrix_file(write("")));
  EXPECT_FALSE(is_matrix_file(path / "none"));
}

TEST_F(MtxFile, IsReadAsArray) {
  EXPECT_EQ(matrix("%%MatrixMarket matrix array real general\n% a comment\n\n2 3\n1\n2\n3.5e0\n-4\n+5\n6"),
            (Matrix(2, 3) << 1, 3.5, 5, 2, -4, 6).finished());
  EXPECT_EQ(matrix("%%matrixmarket MATRIX Array Integer Symmetric\r\n2 2\r\n1\r\n2\r\n3\r\n"),
            (Matrix(2, 2) << 1, 2, 2, 3).finished());
  EXPECT_EQ(matrix("%%MatrixMarket matrix array real skew-symmetric\n3 3\n1\n2\n3\n"),
            (Matrix(3, 3) << 0, -1, -2, 1, 0, -3, 2, 3, 0).finished());
  EXPECT_THAT(vector("%%MatrixMarket matrix array real general\n3 1\n1\n2\n3\n"), testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(vector("%%MatrixMarket matrix array real general\n1 3\n1\n2\n3\n"), testing::ElementsAre(1, 2, 3));
}

TEST_F(MtxFile, IsReadAsCoordinates) {
  EXPECT_EQ(matrix("%%MatrixMarket matrix coordinate real general\n2 3 3\n1 1 1.5\n2 3 -2\n\n% half of it "
                   "again\n2 3 -1\n"),
            (Matrix(2, 3) << 1.5, 0, 0, 0, 0, -3).finished());
  EXPECT_EQ(matrix("%%MatrixMarket matrix coordinate pattern general\n2 2 2\n1 2\n2 1"),
            (Matrix(2, 2) << 0, 1, 1, 0).finished());
  EXPECT_EQ(matrix("%%MatrixMarket matrix coordinate integer symmetric\n3 3 3\n1 1 4\n2 1 5\n3 2 6\n"),
            (Matrix(3, 3) << 4, 5, 0, 5, 0, 6, 0, 6, 0).finished());
  EXPECT_EQ(matrix("%%MatrixMarket matrix coordinate pattern symmetric\n2 2 1\n2 1\n"),
            (Matrix(2, 2) << 0, 1, 1, 0).finished());
  EXPECT_EQ(matrix("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 7\n"),
            (Matrix(2, 2) << 0, -7, 7, 0).finished());
  EXPECT_EQ(matrix("%%MatrixMarket matrix coordinate real general\n2 2 0\n"), Matrix(Matrix::Zero(2, 2)));
}

TEST_F(MtxFile, IsRefusedByLineAndExpectation) {
  const std::string array = "%%MatrixMarket matrix array real general\n",
                    coordinate = "%%MatrixMarket matrix coordinate real general\n",
                    symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
  expect_refusal("%%MatrixMarket matrix array complex general\n1 1\n1 1\n",
                 ":1: word 4 of the first line is \"complex\", expected real or integer or pattern");
  expect_refusal("%%MatrixMarket matrix coordinate real hermitian\n", "word 5 of the first line is \"hermitian\"");
  expect_refusal("%%MatrixMarket vector array real general\n", "word 2 of the first line is \"vector\"");
  expect_refusal("%%MatrixMarket matrix dense real general\n", "word 3 of the first line is \"dense\"");
  expect_refusal("%%MatrixMarket matrix array real\n1 1\n1\n", "word 5 of the first line is missing");
  expect_refusal("%%MatrixMarket matrix array pattern general\n1 1\n", ":1: an array cannot be a pattern");
  expect_refusal("%%MatrixMarket matrix coordinate pattern skew-symmetric\n", ":1: a pattern cannot be skew-symmetric");
  expect_refusal("%%MatrixMarket matrix array real general 7\n", ":1: the first line has more than 5 words");
  expect_refusal("%%MatrixMarket", "word 2 of the first line is missing");
  expect_refusal(array, ":2: expected the number of rows");
  expect_refusal(array + "2\n", ":2: expected the number of columns");
  expect_refusal(array + "0 2\n", ":2: the number of rows is 0, expected 1 or more");
  expect_refusal(array + "2 -1\n", ":2: the number of columns is -1, expected 1 or more");
  expect_refusal(array + "1 1 1\n1\n", ":2: expected the end of the line after the size");
  expect_refusal(array + "2 1\n1\n2,5\n", ":4: expected a number, found \"2,5\"");
  expect_refusal(array + "3 1\n1\n2        \n", ": expected a number, the file ends");
  expect_refusal(array + "1 1\n1\n% more\n2\n", ":5: expected the end of the file after all entries");
  expect_refusal("%%MatrixMarket matrix array integer general\n1 1\n1.5\n",
                 ":3: expected a whole number, found \"1.5\"");
  expect_refusal("%%MatrixMarket matrix array real symmetric\n2 3\n", ":2: is 2 x 3 and symmetric");
  expect_refusal(coordinate + "2 2\n", ":2: expected the number of entries");
  expect_refusal(coordinate + "2 2 1\n3 1 1\n", ":3: row 3 does not exist, expected 1 to 2");
  expect_refusal(coordinate + "2 2 1\n1 0 1\n", ":3: column 0 does not exist, expected 1 to 2");
  expect_refusal(coordinate + "2 2 1\n1 1 1 1\n", ":3: expected the end of the line after an entry");
  expect_refusal(coordinate + "2 2 1\n1 1\n     ", ":3: expected a number, the line ends");
  expect_refusal(coordinate + "2 2 1\n1 1 1\n2 2 2\n", ":4: expected the end of the file after all entries");
  expect_refusal(symmetric + "2 2 1\n1 2 5\n", ":3: entry (1, 2) is above the diagonal");
  expect_refusal("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 2 5\n",
                 "entry (2, 2) is on the diagonal");
}

TEST_F(MtxFile, WithALyingHeaderIsRefusedBeforeAnythingIsAllocated) {
  const std::string array = "%%MatrixMarket matrix array real ", coordinate = "%%MatrixMarket matrix coordinate real ";
  expect_refusal(array + "general\n1000000 1000000\n1\n", "cannot hold them");
  expect_refusal(array + "general\n9223372036854775807 1\n1\n", "cannot hold them");
  expect_refusal(array + "general\n1 9223372036854775807\n1\n", "cannot hold them");
  expect_refusal(array + "symmetric\n4000000000 4000000000\n1\n", "cannot hold them");
  expect_refusal(coordinate + "general\n5 5 9223372036854775807\n1 1 1\n", "cannot hold them");
  expect_refusal(coordinate + "general\n5 5 -1\n", "the number of entries is negative");
  expect_refusal(coordinate + "general\n1000000000 1000000000 1\n1 1 1\n", ":2: a matrix of 1000000000 x 1000000000");
}

/// A small file of each kind.
std::vector<std::string> samples() {
  const Matrix A = random_matrix(4, 3, 1, 1);
  return {npy<double>(A, "<f8", false),
          npy<double>(A, ">f8", true, 3),
          npy<float>(A, "<f4", false, 2),
          npy<std::int16_t>(Matrix::Ones(2, 5), ">i2", false),
          npy_header(1, "<f8", false, "(4,)") + raw<double>(std::vector<double>{1, 2, 3, 4}),
          "%%MatrixMarket matrix array real general\n% two\n2 3\n1\n2.5\n3\n-4e-3\n5\n6\n",
          "%%MatrixMarket matrix array integer symmetric\n3 3\n1\n2\n3\n4\n5\n6\n",
          "%%MatrixMarket matrix coordinate real general\n3 4 3\n1 1 1.5\n2 4 -2\n3 3 1e5\n",
          "%%MatrixMarket matrix coordinate pattern symmetric\n3 3 2\n2 1\n3 3\n"};
}

/// Reads what may be damaged. \return whether it was refused.
bool is_refused(const MatrixFile& file, const std::string& bytes) {
  bool refused = false;
  file.write(bytes);
  const auto expect_sound = [&](const auto& read) {
    try {
      const Matrix values = read();
      EXPECT_GT(values.size(), 0);
      EXPECT_TRUE(values.allFinite());
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.path.string()));
      refused = true;
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << " for " << testing::PrintToString(bytes);
    }
  };
  expect_sound([&]() -> Matrix { return read_matrix(file.path); });
  expect_sound([&]() -> Matrix { return read_vector(file.path); });
  return refused;
}

TEST_F(MatrixFile, CutOffAnywhereIsRefusedOrFinite) {
  for (const std::string& bytes : samples())
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const bool refused = is_refused(*this, bytes.substr(0, size));
      EXPECT_TRUE(refused || bytes.front() == '%') << size;  // a cut number of a text is a number still
    }
}

}  // namespace
}  // namespace supple::test
