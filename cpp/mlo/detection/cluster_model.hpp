#pragma once

#include "mlo/detection/candidates.hpp"

namespace mlo {

/// Probability that a candidate is what it is taken for, by a logistic model with one weight for each feature
/// and each product of two, fitted on simulated scenes (scripts/fit_cluster_model.py).
double probability_of(const Candidate& candidate);

}  // namespace mlo
