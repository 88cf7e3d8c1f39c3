#pragma once
/// \file Tables as comma-separated text (RFC 4180), read and written: a header with units, then one line a row.

#include <core/types.hpp>

#include <concepts>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace supple {

/// Rows of numbers and text under named columns. Numbers are kept as the shortest text that gives back the
/// same double, whatever the locale.
class CsvTable {
 public:
  struct Column {
    std::string name;
    std::string unit = {};  ///< written as "name [unit]"; empty: none
  };

  /// \throws std::invalid_argument if there is no column, or two have the same name.
  explicit CsvTable(std::vector<Column> columns);
  /// CsvTable{{"time", "s"}, {"energy", "J"}}
  CsvTable(std::initializer_list<Column> columns) : CsvTable(std::vector<Column>(columns)) {}

  /// One cell a column, each a number or a text. \throws std::invalid_argument if there are more or fewer.
  template <typename... Cells>
  void add_row(const Cells&... cells) {
    add_cells({to_cell(cells)...});
  }
  void add_cells(std::vector<std::string> cells);

  Index num_rows() const { return static_cast<Index>(rows_.size()); }
  const std::vector<Column>& columns() const { return columns_; }
  bool contains(std::string_view name) const;
  /// The numbers of a column, for all rows.
  /// \throws InputError naming file, line and cell if one is not a number, or the columns that are there if
  /// this one is not.
  Vector numbers(std::string_view name) const;
  std::vector<std::string> texts(std::string_view name) const;

 private:
  friend CsvTable read_csv(const std::filesystem::path& path);
  friend void write_csv(const std::filesystem::path& path, const CsvTable& table);

  static std::string to_cell(std::string_view text) { return std::string(text); }
  static std::string to_cell(double value);
  static std::string to_cell(std::integral auto value) { return std::to_string(value); }
  std::size_t find(std::string_view name) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<Index> lines_;  // where each row began in the file, if the table came from one
  std::string source_ = "table";
};

/// Writes the whole table; an old file is replaced in one step. \throws InputError if it cannot be written.
void write_csv(const std::filesystem::path& path, const CsvTable& table);

/// Reads a table as write_csv writes it; other programs' tables, too, if every row has a cell for each
/// column.
/// \throws InputError naming file, line and expectation.
CsvTable read_csv(const std::filesystem::path& path);

}  // namespace supple
