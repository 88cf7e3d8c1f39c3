#pragma once
/// \file Choices by name: entries with a description and options, which commands, files and plug-ins choose from.

#include <core/check.hpp>
#include <core/text.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supple {

/// "red, green": what `name` makes of the items of a range.
template <typename Range, typename Name = std::identity>
std::string listed(const Range& items, Name name = {}) {
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "" : ", ") + std::string(std::invoke(name, item));
  return text;
}

/// The names of an enum's values, in one table: specialise it beside the enum,
/// `template <> inline constexpr std::array names_of<Colour>{Named{Colour::Red, "red"}, …};`.
template <typename E>
struct Named {
  E value;
  std::string_view name;
};
template <typename E>
Named(E, const char*) -> Named<E>;
template <typename E>
inline constexpr auto names_of = nullptr;

template <typename E>
std::vector<std::string> all_names_of() {
  std::vector<std::string> names;
  for (const auto& [value, name] : names_of<E>) names.emplace_back(name);
  return names;
}
template <typename E>
constexpr std::string_view name_of(E value) {
  for (const auto& [known, name] : names_of<E>)
    if (known == value) return name;
  return "unknown";
}
/// \throws std::invalid_argument naming those that there are. \param what  for the message: "solver".
template <typename E>
E value_named(std::string_view name, std::string_view what) {
  for (const auto& [value, known] : names_of<E>)
    if (known == name) return value;
  throw std::invalid_argument(std::string(what) + " '" + std::string(name) + "' is not known, expected one of " +
                              listed(all_names_of<E>()));
}

/// \throws std::invalid_argument unless a user can write the name in a Choice: letters, digits, '-', '_' and '.' only.
inline void require_name(std::string_view name, const std::string& what) {
  const auto fits = [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  };
  require(!name.empty() && std::ranges::all_of(name, fits),
          "the name of " + what + " is '" + std::string(name) + "', expected letters, digits, '-', '_' and '.'");
}

enum class OptionType { WholeNumber, Number, Flag, Word };

/// An option of an entry, as users see it.
struct OptionInfo {
  std::string name;
  OptionType type = OptionType::Number;
  std::string default_value;  ///< as one would write it
  std::string meaning;        ///< a few words, with the unit
};

/// Values of options by name, as text.
using OptionValues = std::vector<std::pair<std::string, std::string>>;

/// A choice as a user writes it, "nn-sp:max_iterations=12:patience=3": a name, then options between colons.
struct Choice {
  std::string name;
  OptionValues options = {};

  /// \throws std::invalid_argument for an option without '=' or one that comes twice.
  static Choice parse(std::string_view text) {
    Choice choice;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(':', begin), text.size());
      const std::string part(text.substr(begin, end - begin));
      if (begin == 0) {
        choice.name = part;
      } else {
        const std::size_t equals = part.find('=');
        require(equals != std::string::npos && equals > 0,
                "'" + std::string(text) + "': option '" + part + "' is not of the form name=value");
        std::string name = part.substr(0, equals);
        for (const auto& [other, value] : choice.options)
          require(other != name, "'" + std::string(text) + "' has the option '" + name + "' twice");
        choice.options.emplace_back(std::move(name), part.substr(equals + 1));
      }
      begin = end + 1;
    }
    return choice;
  }
};

/// The options of a type whose members they are: OptionsOf(NnSp{}).add("patience", &NnSp::patience, "…"). Members may be
/// Index, std::uint64_t, double, bool, std::string and enums with names_of.
template <typename T>
class OptionsOf {
 public:
  explicit OptionsOf(T defaults = {}) : defaults_(std::move(defaults)) {}

  /// \throws std::invalid_argument for a name that cannot be written in a Choice, or that is there already.
  template <typename Member>
  OptionsOf& add(std::string name, Member T::*member, std::string meaning) {
    require_name(name, "an option");
    require(std::ranges::find(items_, name, &Item::name) == items_.end(), "there is an option '" + name + "' already");
    OptionInfo info{name, type_of<Member>(), text_of(defaults_.*member), std::move(meaning)};
    items_.push_back({std::move(info), [name, member](T& object, const std::string& text) {
                        object.*member = value_of<Member>(name, text);
                      }});
    return *this;
  }

  std::vector<OptionInfo> info() const {
    std::vector<OptionInfo> infos;
    for (const Item& item : items_) infos.push_back(item.info);
    return infos;
  }

  /// The defaults with some members replaced. \throws std::invalid_argument for a name that there is not, and for a value
  /// that is not of the member's type. \param whose  for messages: "selector nn-sp".
  T make(const OptionValues& values, const std::string& whose) const {
    T result = defaults_;
    for (const auto& [name, text] : values) {
      const auto found = std::ranges::find(items_, name, &Item::name);
      require(found != items_.end(), whose + " has no option '" + name + "', expected " +
                                         (items_.empty() ? "none" : "one of ") + listed(items_, &Item::name));
      try {
        found->set(result, text);
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(whose + ": " + error.what());
      }
    }
    return result;
  }

 private:
  struct Item {
    OptionInfo info;
    std::function<void(T&, const std::string&)> set;

    const std::string& name() const { return info.name; }
  };

  template <typename Member>
  static constexpr OptionType type_of() {
    if constexpr (std::same_as<Member, bool>)
      return OptionType::Flag;
    else if constexpr (std::integral<Member>)
      return OptionType::WholeNumber;
    else if constexpr (std::floating_point<Member>)
      return OptionType::Number;
    else
      return OptionType::Word;
  }
  template <typename Member>
  static std::string text_of(const Member& value) {
    if constexpr (std::same_as<Member, bool>) {
      return value ? "yes" : "no";
    } else if constexpr (std::is_enum_v<Member>) {
      return std::string(name_of(value));
    } else if constexpr (std::is_arithmetic_v<Member>) {
      return exact(value);
    } else {
      return value;
    }
  }
  template <typename Member>
  static Member value_of(const std::string& name, const std::string& text) {
    const auto fail = [&](const char* expected) {
      throw std::invalid_argument("option '" + name + "' is '" + text + "', expected " + expected);
    };
    if constexpr (std::same_as<Member, bool>) {
      if (text == "yes" || text == "true" || text == "1") return true;
      if (text != "no" && text != "false" && text != "0") fail("yes or no");
      return false;
    } else if constexpr (std::is_enum_v<Member>) {
      return value_named<Member>(text, "option '" + name + "':");
    } else if constexpr (std::is_arithmetic_v<Member>) {
      Member value{};
      const char* const last = text.data() + text.size();
      const auto [end, error] = std::from_chars(text.data(), last, value);
      if (error != std::errc() || end != last || value != value)
        fail(std::integral<Member> ? "a whole number" : "a number");
      return value;
    } else {
      return text;
    }
  }

  T defaults_;
  std::vector<Item> items_;
};

/// What is known by name: own entries, and those that plug-ins and programs add. An entry has a `name`; references to
/// entries stay valid. Safe from several threads.
template <typename Entry>
class Registry {
 public:
  /// \param kind  for messages: "selector".  \param hint  how others come in, for messages; may be empty.
  Registry(std::string kind, std::vector<Entry> own, std::string hint = "")
      : kind_(std::move(kind)), hint_(std::move(hint)) {
    for (Entry& entry : own) entries_.push_back(std::move(entry));
  }

  const std::string& kind() const { return kind_; }

  /// \throws std::invalid_argument as require_new.
  void add(Entry entry) {
    const std::scoped_lock lock(mutex_);
    require_absent(entry.name);
    entries_.push_back(std::move(entry));
  }
  /// \throws std::invalid_argument if there is one of this name, or if users cannot write it in a Choice.
  void require_new(std::string_view name) const {
    const std::scoped_lock lock(mutex_);
    require_absent(name);
  }

  /// \throws std::invalid_argument naming those that there are.
  const Entry& at(std::string_view name) const {
    const std::scoped_lock lock(mutex_);
    if (const Entry* entry = found(name)) return *entry;
    throw std::invalid_argument(kind_ + " '" + std::string(name) + "' is not known, expected one of " +
                                listed(entries_, &Entry::name) + hint_);
  }
  bool contains(std::string_view name) const {
    const std::scoped_lock lock(mutex_);
    return found(name);
  }
  /// In the order in which they came, the default first.
  std::vector<std::string> names() const {
    const std::scoped_lock lock(mutex_);
    std::vector<std::string> names;
    for (const Entry& entry : entries_) names.emplace_back(entry.name);
    return names;
  }

 private:
  void require_absent(std::string_view name) const {
    require_name(name, "a " + kind_);
    require(!found(name), "there is a " + kind_ + " '" + std::string(name) + "' already");
  }
  const Entry* found(std::string_view name) const {
    for (const Entry& entry : entries_)
      if (entry.name == name) return &entry;
    return nullptr;
  }

  std::string kind_, hint_;
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;  // stay where they are
};

/// "  nn-sp: non-negative subspace pursuit\n      patience=10: draws …\n" of each entry, for helps.
template <typename Entry>
std::string described(const Registry<Entry>& registry) {
  std::string text;
  for (const std::string& name : registry.names()) {
    const Entry& entry = registry.at(name);
    text += "  " + name + ": " + entry.description + "\n";
    for (const OptionInfo& option : entry.options)
      text += "      " + option.name + "=" + option.default_value + ": " + option.meaning + "\n";
  }
  return text;
}

}  // namespace supple
