#include <app/commands/option_checks.hpp>
#include <app/report/terminal.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/model_ladder.hpp>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

namespace supple {

namespace {

/// \param complaint  what is wrong with a text, empty if nothing is. No description goes with it: help shows the type.
template <typename Complaint>
CLI::Validator check(Complaint complaint) {
  return {[complaint](std::string& text) -> std::string { return complaint(text); }, ""};
}

}  // namespace

CLI::Validator whole_number(Index least) {
  return check([least](const std::string& text) {
    Index value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    return whole && value >= least ? "" : "'" + text + "' is no whole number from " + std::to_string(least) + " up";
  });
}

CLI::Validator positive_number() {
  return check([](const std::string& text) {
    double value = 0;
    const bool number = CLI::detail::lexical_cast(text, value);
    return number && value > 0 && std::isfinite(value) ? "" : "'" + text + "' is no number > 0";
  });
}

CLI::Validator number_between(double low, double high) {
  return check([low, high](const std::string& text) {
    double value = 0;
    const bool number = CLI::detail::lexical_cast(text, value);
    return number && value >= low && value <= high
               ? ""
               : "'" + text + "' is no number from " + shown(low) + " to " + shown(high);
  });
}

CLI::Validator model_words() {
  return check([](const std::string& text) -> std::string {
    try {
      (void)ModelWords::parse(text);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  });
}

CLI::Validator subspace_name() {
  return check([](const std::string& text) -> std::string {
    try {
      (void)parts_of_subspace(text);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  });
}

}  // namespace supple
