#include <reduction/pipeline/model_series.hpp>

namespace supple {

ReducedModel ModelSeries::make(const ReduceOptions& options, ReduceReport& report) {
  const bool shares = trained_ && options.subspace == last_.subspace && options.modes == last_.modes &&
                      options.dimension == last_.dimension && options.relaxed == last_.relaxed;
  if (!shares) {
    trained_.reset();  // two at a time may not fit into memory
    trained_.emplace(body_, options, progress_);
    last_ = options;
  }
  return trained_->model(options.points, &report);
}

}  // namespace supple
