#pragma once
/// \file What is done to an object to see whether its simulation stays sane, and what becomes of it.

#include <app/scene/simulation.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A motion far beyond what a model was made for, by name.
struct HardshipInfo {
  std::string_view name, description;
};
inline constexpr std::array<HardshipInfo, 8> all_hardships{{
    {"pull-0.1", "pulled to a tenth of the diagonal by linear theory, then released"},
    {"pull-1", "pulled to one diagonal by linear theory, then released"},
    {"pull-10", "pulled to ten diagonals by linear theory, then released"},
    {"crush", "one end pressed onto the other by springs"},
    {"invert", "one end pulled through the other, to where it is as far on the other side"},
    {"wring", "one end turned six times"},
    {"blow", "half of it brought to ten diagonals a period within a tenth of a period"},
    {"jumps", "a push on half of it that changes its sign every quarter of a period"},
}};

/// One of them for a model.
struct Hardship {
  HardshipInfo info;
  Scene scene;
};

/// All of them, in their order, each for three periods T of the softest flexible mode; undamped.
std::vector<Hardship> hardships(const ReducedModel& model);

/// How a run went, for the reader of a table.
enum class Verdict {
  Sound,    ///< every step reached its tolerance, and the integrator made at most 1 % of what loads brought
  Warned,   ///< it went on to its end, and said that one of these does not hold
  Stopped,  ///< it ended early, and said so
};
std::string_view to_string(Verdict verdict);

/// A hardship under one integrator and step.
struct StressRun {
  std::string hardship, integrator;  ///< by name; as it was chosen
  double steps_per_period = 0;
  Index steps_asked = 0, steps_done = 0, halved = 0, rescued = 0, missed = 0;
  double worst_residual = 0;
  double energy_made = 0, energy_taken = 0;  ///< see Effort
  double reach = 0;                          ///< largest displacement of the tracked node over the diagonal
  double seconds = 0;                        ///< of the steps
  Ending ending = Ending::Complete;

  Verdict verdict() const;
};

/// \param integrator  as a user chooses it.  \param full  runs the full object, else the model.
StressRun endure(const ReducedModel& model, const Hardship& hardship, const std::string& integrator,
                 double steps_per_period, bool full);

}  // namespace supple
