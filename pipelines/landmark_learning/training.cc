#include "pipelines/landmark_learning/training.h"

#include <algorithm>

namespace cairn::landmark_learning {
namespace {

template <class S, class F>
void VisitVectors(S& t, const F& f) {
  f("weights", t.weights);
  f("best", t.best);
  f("error", t.error);
  f("validation", t.validation);
  f("norm", t.norm);
}

}  // namespace

Blob Training::ToBlob() const {
  Blob blob;
  VisitVectors(*this,
               [&](const char* name, const std::vector<double>& values) { blob.PutVector(name, values); });
  blob.PutAll("descent/", descent.ToBlob());
  blob.PutScalar("prior", prior);
  blob.PutScalar("validation_prior", validation_prior);
  blob.PutScalar("since_best", since_best);
  return blob;
}

Training Training::FromBlob(const Blob& blob) {
  Training t;
  VisitVectors(t, [&](const char* name, std::vector<double>& values) {
    const auto stored = blob.Get<double>(name);
    values.assign(stored.begin(), stored.end());
  });
  t.descent = Descent::FromBlob(blob.Sub("descent/"));
  t.prior = blob.Scalar<double>("prior");
  t.validation_prior = blob.Scalar<double>("validation_prior");
  t.since_best = blob.Scalar<std::int64_t>("since_best");
  return t;
}

NetworkShape ShapeOf(const Options& options, std::size_t inputs) {
  return {static_cast<int>(options.networks), static_cast<int>(inputs), static_cast<int>(options.hidden)};
}

DescentRules RulesOf(const Options& options) {
  const Method method = options.method == "gradient"   ? Method::kGradient
                        : options.method == "momentum" ? Method::kMomentum
                                                       : Method::kAdam;
  return {method, options.rate, options.momentum, options.weight_decay};
}

Parameters<float> InFloat(const NetworkShape& shape, const std::vector<double>& weights) {
  Parameters<float> parameters(shape);
  std::ranges::transform(weights, parameters.values.begin(), [](double w) { return static_cast<float>(w); });
  return parameters;
}

}  // namespace cairn::landmark_learning
