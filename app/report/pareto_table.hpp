#pragma once
/// \file Models of one object, measured in time and error, as tables, a plot and a page.

#include <app/report/json_report.hpp>
#include <reduction/pipeline/reduce_options.hpp>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace supple {

/// A model and the solver's tolerance, measured.
struct ParetoPoint {
  std::string model;     ///< in words, as --models takes it
  std::string subspace;  ///< with its options
  Index modes = 0, dimension = 0, points = 0;
  double tolerance = 0;        ///< of a step, relative residual
  double reduce_seconds = 0;   ///< to make the model alone [s]
  double step_seconds = 0;     ///< of a step, median [s]
  double mean_iterations = 0;  ///< of a step
  Index missed_steps = 0;      ///< that did not reach the tolerance
  bool complete = true;        ///< whether the motion runs to its end; else the point is on no front
  FullError full_error;        ///< of equilibria
  double training_error = 0, held_out_error = 0;
  double trajectory_error =
      std::numeric_limits<double>::quiet_NaN();  ///< of the motion's positions; NaN if not compared
  bool front = false;
};

/// Which error the front is of.
enum class ParetoError { Equilibria, Trajectory };

/// Marks the points on the front of step_seconds and the error.
void mark_front(std::vector<ParetoPoint>& points, ParetoError error);

Json points_json(const std::vector<ParetoPoint>& points);
/// A row for each point.
void write_points(const std::filesystem::path& path, const std::vector<ParetoPoint>& points);
std::string markdown_table(const std::vector<ParetoPoint>& points, ParetoError error);
/// What the columns of the table mean.
std::string pareto_notes(ParetoError error);

/// Error against time, the front as a line. \return whether there was a point to draw.
bool draw_pareto_plot(const std::filesystem::path& path, const std::string& title,
                      const std::vector<ParetoPoint>& points, ParetoError error);
/// A page with the table and, if there is one, the plot in a PNG file.
void write_pareto_page(const std::filesystem::path& path, const std::string& title, const std::string& description,
                       const std::vector<ParetoPoint>& points, ParetoError error, const std::filesystem::path& plot);

}  // namespace supple
