#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/text.hpp>
#include <io/text/json_fields.hpp>
#include <io/text/unit.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace supple {

namespace {

using Json = nlohmann::json;

/// A value as it may stand in a message.
std::string shown(const Json& value) {
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  if (value.is_object()) return "an object";
  if (value.is_number_float()) return exact(value.get<double>());
  if (!value.is_string()) return value.dump();
  std::string text = value.get<std::string>();
  if (text.size() > 60) {
    std::size_t end = 60;
    while ((text[end] & 0xc0) == 0x80) --end;  // not inside a UTF-8 sequence
    text = text.substr(0, end) + "…";
  }
  return Json(text).dump();
}

/// A step of a JSON pointer (RFC 6901).
std::string step(std::string_view key) {
  std::string text = "/";
  for (const char c : key) text += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
  return text;
}

/// "3:14" of a byte in a text.
std::string position(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 = 0
  return std::to_string(line) + ":" + std::to_string(column);
}

}  // namespace

std::string Interval::to_string() const {
  const std::string from = (low_open ? "> " : ">= ") + exact(low), to = (high_open ? "< " : "<= ") + exact(high);
  if (low == -infinity) return high == infinity ? "any number" : to;
  if (high == infinity) return from;
  return low_open || high_open ? from + " and " + to : "between " + exact(low) + " and " + exact(high);
}

struct JsonFields::Document {
  std::string source;
  Json root;
  struct Asked {
    const Json* object;
    std::set<std::string> keys;
  };
  std::map<std::string, Asked> asked;  // by place
};

namespace {

const Json& as_json(const void* value) {
  return *static_cast<const Json*>(value);
}

}  // namespace

JsonFields::JsonFields(std::shared_ptr<Document> document, std::string place, const void* value)
    : document_(std::move(document)), place_(std::move(place)), value_(value) {
  document_->asked.try_emplace(place_, Document::Asked{&as_json(value_), {}});
}

JsonFields JsonFields::read(const std::filesystem::path& path) {
  return parse(read_file(path), path.string());
}

JsonFields JsonFields::parse(std::string_view text, std::string source) {
  auto document = std::make_shared<Document>();
  document->source = std::move(source);
  const auto refuse = [&](std::size_t byte, const std::string& reason) {
    throw InputError(document->source + ":" + position(text, byte) + ": " + reason);
  };
  // The parser takes a NUL for the end of its input and would ignore what follows.
  if (const std::size_t nul = text.find('\0'); nul != text.npos) refuse(nul, "a NUL byte, expected text");
  std::vector<std::set<std::string>> keys;
  const auto no_duplicates = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw InputError(document->source + ": the key " + shown(parsed) + " appears twice in one object");
    return true;
  };
  try {
    document->root = Json::parse(text, no_duplicates);
  } catch (const Json::parse_error& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while …"
    const std::string_view what = error.what();
    const std::size_t reason = what.find(": ");
    refuse(error.byte > 0 ? error.byte - 1 : 0, std::string(reason == what.npos ? what : what.substr(reason + 2)));
  } catch (const Json::out_of_range& error) {
    // "[json.exception.out_of_range.406] number overflow parsing '1e999'"
    const std::string_view what = error.what();
    const std::size_t begin = what.find('\''), end = what.rfind('\'');
    const std::string_view number = begin < end ? what.substr(begin + 1, end - begin - 1) : std::string_view();
    refuse(text.find(number), "the number " + std::string(number) + " is too large");
  }
  if (!document->root.is_object())
    throw InputError(document->source + ": is " + shown(document->root) + ", expected an object {…}");
  const Json* root = &document->root;
  return JsonFields(std::move(document), "", root);
}

/// A value with its place: what the readers of all kinds of fields share.
struct JsonFields::Field {
  const std::string& source;
  std::string place;
  const Json& value;

  [[noreturn]] void expect(const std::string& expectation) const {
    throw InputError(source + ": " + place + " is " + shown(value) + ", expected " + expectation);
  }

  std::vector<Field> elements(const std::string& kind) const {
    if (!value.is_array()) expect("a list of " + kind);
    std::vector<Field> fields;
    for (std::size_t k = 0; k < value.size(); ++k)
      fields.push_back({source, place + "/" + std::to_string(k), value[k]});
    return fields;
  }

  double number(const Interval& range, std::string_view unit) const {
    const std::string kind = unit.empty() ? "a number" : "a number in " + std::string(unit);
    double number = 0;
    if (value.is_number()) {
      number = value.get<double>();
    } else if (value.is_string() && !unit.empty()) {
      try {
        number = parse_quantity(text(), unit);
      } catch (const InputError& error) {
        expect(kind + ": " + error.what());
      }
    } else {
      expect(kind);
    }
    if (!range.contains(number)) expect(range.to_string() + (unit.empty() ? "" : " " + std::string(unit)));
    return number;
  }

  Index integer(const Interval& range) const {
    constexpr double largest = 0x1p53;  // beyond, a double does not tell neighbours apart
    const double number = value.is_number() ? value.get<double>() : largest + 2;
    if (std::abs(number) > largest || number != std::floor(number)) expect("a whole number");
    if (!range.contains(number)) expect("a whole number " + range.to_string());
    return static_cast<Index>(number);
  }

  const std::string& text() const {
    if (!value.is_string()) expect("a text");
    return value.get_ref<const std::string&>();
  }
};

JsonFields::Field JsonFields::field(std::string_view key) const {
  if (!contains(key)) fail(key, "is missing");
  return {document_->source, place_ + step(key), as_json(value_).find(key).value()};
}

const std::string& JsonFields::source() const {
  return document_->source;
}

bool JsonFields::contains(std::string_view key) const {
  document_->asked.at(place_).keys.emplace(key);
  return as_json(value_).contains(key);
}

bool JsonFields::is_null(std::string_view key) const {
  return field(key).value.is_null();
}

bool JsonFields::is_number(std::string_view key) const {
  return field(key).value.is_number();
}

double JsonFields::number(std::string_view key, const Interval& range, std::string_view unit) const {
  return field(key).number(range, unit);
}

Index JsonFields::integer(std::string_view key, const Interval& range) const {
  return field(key).integer(range);
}

bool JsonFields::flag(std::string_view key) const {
  const Field flag = field(key);
  if (!flag.value.is_boolean()) flag.expect("true or false");
  return flag.value.get<bool>();
}

std::string JsonFields::text(std::string_view key) const {
  return field(key).text();
}

std::string JsonFields::choice(std::string_view key, const std::vector<std::string>& options) const {
  const Field choice = field(key);
  if (choice.value.is_string() && std::ranges::find(options, choice.text()) != options.end()) return choice.text();
  std::string list;
  for (const std::string& option : options) list += (list.empty() ? "\"" : ", \"") + option + '"';
  choice.expect("one of " + list);
}

Vector JsonFields::numbers(std::string_view key, Index size, const Interval& range, std::string_view unit) const {
  const Field list = field(key);
  const std::vector<Field> elements = list.elements("numbers");
  Vector values(static_cast<Index>(elements.size()));
  if (size != any_size && values.size() != size) list.expect("a list of " + std::to_string(size));
  for (Index k = 0; k < values.size(); ++k) values[k] = elements[k].number(range, unit);
  return values;
}

std::vector<Index> JsonFields::integers(std::string_view key, const Interval& range) const {
  std::vector<Index> values;
  for (const Field& element : field(key).elements("whole numbers")) values.push_back(element.integer(range));
  return values;
}

std::vector<std::string> JsonFields::texts(std::string_view key) const {
  std::vector<std::string> values;
  for (const Field& element : field(key).elements("texts")) values.push_back(element.text());
  return values;
}

JsonFields JsonFields::object(std::string_view key) const {
  const Field object = field(key);
  if (!object.value.is_object()) object.expect("an object");
  return {document_, object.place, &object.value};
}

std::vector<JsonFields> JsonFields::objects(std::string_view key) const {
  std::vector<JsonFields> values;
  for (const Field& element : field(key).elements("objects")) {
    if (!element.value.is_object()) element.expect("an object");
    values.push_back(JsonFields(document_, element.place, &element.value));
  }
  return values;
}

void JsonFields::fail(std::string_view key, std::string_view reason) const {
  throw InputError(document_->source + ": " + place_ + step(key) + " " + std::string(reason));
}

void JsonFields::finish() const {
  for (const auto& [place, asked] : document_->asked)
    for (const auto& [key, value] : asked.object->items()) {
      if (asked.keys.contains(key)) continue;
      const std::optional<std::string> meant = nearest_word(key, {asked.keys.begin(), asked.keys.end()});
      throw InputError(document_->source + ": " + place + step(key) + " is not known here" +
                       (meant ? "; did you mean \"" + *meant + "\"?" : ""));
    }
}

std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& known) {
  if (word.size() > 100) return {};
  std::optional<std::string> nearest;
  std::size_t smallest = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& candidate : known) {
    // Optimal string alignment: insertions, deletions, replacements and swaps of neighbours (Damerau 1964).
    std::vector<std::size_t> row(candidate.size() + 1), previous, before;
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= word.size(); ++i) {
      before = std::exchange(previous, row);
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const bool same = word[i - 1] == candidate[j - 1];
        row[j] = std::min({previous[j] + 1, row[j - 1] + 1, previous[j - 1] + !same});
        if (i > 1 && j > 1 && word[i - 1] == candidate[j - 2] && word[i - 2] == candidate[j - 1])
          row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    if (row.back() < smallest) {
      smallest = row.back();
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace supple
