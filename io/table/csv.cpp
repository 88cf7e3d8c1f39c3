#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/text.hpp>
#include <io/table/csv.hpp>

#include <algorithm>
#include <charconv>

namespace supple {

namespace {

std::string csv_cell(const std::string& cell) {
  const bool plain =
      cell.find_first_of(",\"\r\n") == cell.npos && (cell.empty() || (cell.front() != ' ' && cell.back() != ' '));
  if (plain) return cell;
  std::string text = "\"";
  for (const char c : cell) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

/// "name [unit]" taken apart.
CsvTable::Column parse_column(const std::string& title) {
  const std::size_t bracket = title.rfind(" [");
  if (bracket == title.npos || title.back() != ']') return {title, ""};
  return {title.substr(0, bracket), title.substr(bracket + 2, title.size() - bracket - 3)};
}

/// Splits the text into records one by one and knows the line it stands in.
class Records {
 public:
  Records(std::string_view text, std::string source) : text_(text), source_(std::move(source)) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);  // a byte-order mark
  }

  bool done() const { return at_ >= text_.size(); }
  Index line() const { return line_; }

  std::vector<std::string> next() {
    std::vector<std::string> cells;
    do cells.push_back(next_cell());
    while (at_ < text_.size() && text_[at_] == ',' && ++at_);
    if (at_ < text_.size() && text_[at_] == '\r') ++at_;
    if (at_ < text_.size() && text_[at_] != '\n') fail("expected ',' or the end of the line after a quoted cell");
    ++at_, ++line_;
    return cells;
  }

 private:
  std::string next_cell() {
    std::string cell;
    if (at_ >= text_.size() || text_[at_] != '"') {
      const std::size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
      cell = text_.substr(at_, end - at_);
      at_ = end;
      return cell;
    }
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (++at_ >= text_.size() || text_[at_] != '"') return cell;
      } else if (text_[at_] == '\n') {
        ++line_;
      }
      cell += text_[at_];
    }
    fail("expected a closing quotation mark before the end of the file");
  }
  [[noreturn]] void fail(const std::string& expectation) const {
    throw InputError(source_ + ":" + std::to_string(line_) + ": " + expectation);
  }

  std::string_view text_;
  std::string source_;
  std::size_t at_ = 0;
  Index line_ = 1;
};

}  // namespace

CsvTable::CsvTable(std::vector<Column> columns) : columns_(std::move(columns)) {
  require(!columns_.empty(), "a table has no columns, expected at least one");
  for (auto column = columns_.begin(); column != columns_.end(); ++column)
    require(std::none_of(columns_.begin(), column, [&](const Column& other) { return other.name == column->name; }),
            "two columns have the name '" + column->name + "'");
}

std::string CsvTable::to_cell(double value) {
  return exact(value);
}

void CsvTable::add_cells(std::vector<std::string> cells) {
  require_size("row", static_cast<Index>(cells.size()), static_cast<Index>(columns_.size()));
  rows_.push_back(std::move(cells));
}

bool CsvTable::contains(std::string_view name) const {
  return std::ranges::find(columns_, name, &Column::name) != columns_.end();
}

std::size_t CsvTable::find(std::string_view name) const {
  const auto column = std::ranges::find(columns_, name, &Column::name);
  if (column != columns_.end()) return static_cast<std::size_t>(column - columns_.begin());
  std::string names;
  for (const Column& present : columns_) names += (names.empty() ? "'" : ", '") + present.name + "'";
  throw InputError(source_ + ": expected a column '" + std::string(name) + "'; there are " + names);
}

Vector CsvTable::numbers(std::string_view name) const {
  const std::size_t column = find(name);
  Vector values(num_rows());
  for (Index row = 0; row < num_rows(); ++row) {
    const std::string& cell = rows_[row][column];
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), values[row]);
    if (error != std::errc{} || end != cell.data() + cell.size())
      throw InputError(source_ +
                       (lines_.empty() ? ", row " + std::to_string(row + 1) : ":" + std::to_string(lines_[row])) +
                       ": '" + columns_[column].name + "' is '" + cell + "', expected a number");
  }
  return values;
}

std::vector<std::string> CsvTable::texts(std::string_view name) const {
  const std::size_t column = find(name);
  std::vector<std::string> cells;
  for (const auto& row : rows_) cells.push_back(row[column]);
  return cells;
}

void write_csv(const std::filesystem::path& path, const CsvTable& table) {
  std::string text;
  for (const CsvTable::Column& column : table.columns_)
    text += csv_cell(column.unit.empty() ? column.name : column.name + " [" + column.unit + "]") + ',';
  text.back() = '\n';
  for (const auto& row : table.rows_) {
    for (const std::string& cell : row) text += csv_cell(cell) + ',';
    text.back() = '\n';
  }
  write_file(path, text);
}

CsvTable read_csv(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  Records records(text, path.string());
  if (records.done()) throw InputError(path.string() + ": is empty, expected a header");
  std::vector<CsvTable::Column> columns;
  for (const std::string& title : records.next()) columns.push_back(parse_column(title));
  try {
    CsvTable table(columns);
    table.source_ = path.string();
    while (!records.done()) {
      const Index line = records.line();
      std::vector<std::string> cells = records.next();
      if (cells.size() != table.columns_.size())
        throw InputError(path.string() + ":" + std::to_string(line) + ": has " + std::to_string(cells.size()) +
                         " cells, expected " + std::to_string(table.columns_.size()));
      table.add_cells(std::move(cells));
      table.lines_.push_back(line);
    }
    return table;
  } catch (const std::invalid_argument& error) {
    throw InputError(path.string() + ":1: " + error.what());
  }
}

}  // namespace supple
