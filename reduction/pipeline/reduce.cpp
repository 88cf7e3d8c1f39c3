#include <reduction/pipeline/reduce.hpp>
#include <reduction/pipeline/trained_object.hpp>

namespace supple {

ReducedModel reduce(const Body& body, const ReduceOptions& options, ReduceReport* report, const Progress& progress) {
  return TrainedObject(body, options, progress).model(options.points, report);
}

}  // namespace supple
