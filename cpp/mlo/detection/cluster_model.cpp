#include "mlo/detection/cluster_model.hpp"

#include "mlo/core/log_odds.hpp"

namespace mlo {
namespace {

constexpr std::size_t kFeatures = kCandidateFeatures.size();
constexpr std::size_t kTerms = 1 + kFeatures + kFeatures * (kFeatures + 1) / 2;

/// By class, in the order of class_sizes().
constexpr double kWeights[][kTerms] = {
#include "mlo/detection/cluster_weights.inc"
};

std::size_t row_of(ObjectClass object_class) {
  std::size_t row = 0;
  while (class_sizes()[row].object_class != object_class) ++row;
  return row;
}

}  // namespace

double probability_of(const Candidate& candidate) {
  const double* weight = kWeights[row_of(candidate.object_class)];
  double logit = *weight++;
  for (const double feature : candidate.features) logit += *weight++ * feature;
  for (std::size_t i = 0; i < kFeatures; ++i) {
    for (std::size_t j = i; j < kFeatures; ++j) {
      logit += *weight++ * candidate.features[i] * candidate.features[j];
    }
  }
  return probability(logit);
}

}  // namespace mlo
