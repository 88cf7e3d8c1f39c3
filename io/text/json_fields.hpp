#pragma once
/// \file JSON objects, read field by field with every check and a message that names the place.

#include <core/types.hpp>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// The numbers that a field may take.
struct Interval {
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  double low = -infinity, high = infinity;
  bool low_open = false, high_open = false;

  bool contains(double value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
  /// "> 0", "between 0 and 1", "any number"
  std::string to_string() const;
};
constexpr Interval any_number{};
constexpr Interval positive{.low = 0, .low_open = true};
constexpr Interval non_negative{.low = 0};
constexpr Interval at_least(double low) {
  return {.low = low};
}
constexpr Interval between(double low, double high) {
  return {.low = low, .high = high};
}

/// One object of a JSON file. Ask for its fields, then call finish() on the outermost object: it refuses
/// every key that nobody asked for, with the nearest one that somebody did. Copies see the same document.
/// \throws InputError from every member, as "scene.json: /springs/2/stiffness is -3, expected > 0 N/m".
class JsonFields {
 public:
  /// The file's outermost object. Syntax errors come with line and column; a key may appear once.
  static JsonFields read(const std::filesystem::path& path);
  /// The same for text; `source` stands for the file in messages.
  static JsonFields parse(std::string_view text, std::string source);

  bool contains(std::string_view key) const;
  bool is_null(std::string_view key) const;
  bool is_number(std::string_view key) const;  ///< rather than a text with a unit
  const std::string& source() const;
  /// Where this object stands, "/springs/2"; empty for the outermost.
  const std::string& place() const { return place_; }

  /// A finite number in `unit`, or a text with another unit of the same kind, like "200 kPa".
  /// \see parse_quantity
  double number(std::string_view key, const Interval& range = any_number, std::string_view unit = "") const;
  Index integer(std::string_view key, const Interval& range = any_number) const;
  bool flag(std::string_view key) const;
  std::string text(std::string_view key) const;
  /// One of the options.
  std::string choice(std::string_view key, const std::vector<std::string>& options) const;
  /// A list of numbers, of stated length unless `any_size`.
  Vector numbers(std::string_view key, Index size, const Interval& range = any_number,
                 std::string_view unit = "") const;
  Point point(std::string_view key, std::string_view unit = "m") const { return numbers(key, 3, any_number, unit); }
  std::vector<Index> integers(std::string_view key, const Interval& range = any_number) const;
  std::vector<std::string> texts(std::string_view key) const;
  JsonFields object(std::string_view key) const;
  std::vector<JsonFields> objects(std::string_view key) const;
  static constexpr Index any_size = -1;

  /// The same with a value for a field that is not there.
  double number_or(std::string_view key, double fallback, const Interval& range = any_number,
                   std::string_view unit = "") const {
    return contains(key) ? number(key, range, unit) : fallback;
  }
  Index integer_or(std::string_view key, Index fallback, const Interval& range = any_number) const {
    return contains(key) ? integer(key, range) : fallback;
  }
  bool flag_or(std::string_view key, bool fallback) const { return contains(key) ? flag(key) : fallback; }
  std::string text_or(std::string_view key, std::string_view fallback) const {
    return contains(key) ? text(key) : std::string(fallback);
  }
  std::string choice_or(std::string_view key, std::string_view fallback,
                        const std::vector<std::string>& options) const {
    return contains(key) ? choice(key, options) : std::string(fallback);
  }
  Point point_or(std::string_view key, const Point& fallback, std::string_view unit = "m") const {
    return contains(key) ? point(key, unit) : fallback;
  }
  std::optional<JsonFields> object_if(std::string_view key) const {
    return contains(key) ? std::optional(object(key)) : std::nullopt;
  }
  std::vector<JsonFields> objects_if(std::string_view key) const {
    return contains(key) ? objects(key) : std::vector<JsonFields>{};
  }

  /// Refuses a field's value for the caller's own reason: "<source>: <place>/<key> <reason>".
  [[noreturn]] void fail(std::string_view key, std::string_view reason) const;
  /// Refuses keys that nobody asked for, in this object and in all that were read below it.
  void finish() const;

 private:
  struct Document;
  struct Field;
  JsonFields(std::shared_ptr<Document> document, std::string place, const void* value);
  Field field(std::string_view key) const;

  std::shared_ptr<Document> document_;
  std::string place_;
  const void* value_;  // a nlohmann::json inside the document
};

/// Of the known words, the nearest to a misspelt one by edit distance, if any is near enough to be meant.
std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& known);

}  // namespace supple
