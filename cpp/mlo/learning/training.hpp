#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mlo/core/fields.hpp"
#include "mlo/learning/learner.hpp"
#include "mlo/training/config.hpp"

namespace mlo {

/// For scans that are seen all round, and whose ground is level in the network's frame.
AugmentationConfig all_round_augmentation();

/// How a network is trained, as far as it changes the result.
struct TrainingConfig {
  int epochs = 15;
  int batch = 1;
  double learning_rate = 0.002;
  double warm_up = 0.1;
  int every = 1;
  int min_points = 5;
  int seed = 1;
  int torch_threads = 1;
  double weight_decay = 0.01;
  AugmentationConfig augmentation = all_round_augmentation();

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("epochs", epochs, between(1, 10000), "how often each scan is seen");
    visit("batch", batch, between(1, 64), "scans in a step");
    visit("learning_rate", learning_rate, between(1e-6, 0.1), "largest length of steps");
    visit("warm_up", warm_up, between(0.0, 0.9),
          "share of the steps in which their length grows, before it falls along a cosine");
    visit("every", every, between(1, 1000), "only each so many-th scan is used: neighbours are much alike");
    visit("min_points", min_points, between(1, 1000),
          "objects with fewer returns are neither demanded nor wrong");
    visit("seed", seed, between(0, 1000000), "of all that is random");
    visit("torch_threads", torch_threads, between(1, 64),
          "threads of LibTorch; another number may round differently, and so give other weights");
    visit("weight_decay", weight_decay, between(0.0, 1.0), "pull of the weights towards zero (AdamW)");
    visit.group("augmentation", augmentation, "What is done to scans so that no two look alike.");
  }
};

struct TrainingOptions {
  std::vector<std::filesystem::path> folders;     ///< to learn from: anything that open_examples() takes
  std::vector<std::filesystem::path> validation;  ///< to judge by: may be none
  std::filesystem::path out;
  bool resume = false;               ///< go on with the state in `out`, if there is one
  int validate_every = 500;          ///< steps between two judgements, each of which saves the state
  std::size_t max_validation = 200;  ///< scans to judge by, spread over all
  /// What begins the network: a weights file, or nothing for small_architecture() with random weights.
  std::optional<std::filesystem::path> start;
};

/// One line of the curves.
struct TrainingRow {
  long step = 0;
  LossTerms loss;  ///< mean since the line before
  double learning_rate = 0.0;
  std::vector<double> ap;  ///< of each class, in [0, 1]; empty without validation
};

struct TrainingReport {
  std::size_t examples = 0;
  std::size_t validation = 0;
  long steps = 0;
  bool interrupted = false;
  std::vector<std::string> warnings;  ///< scans that could not be used
  std::vector<TrainingRow> rows;
};

/// What is going on, for a progress display.
struct TrainingProgress {
  enum class Phase { loading, training, judging };
  Phase phase = Phase::loading;
  std::size_t done = 0;
  std::size_t total = 0;
  std::optional<TrainingRow> row;  ///< a new line of the curves
};

/// Trains 3DSSD. Writes weights.safetensors, curves.csv, curves.svg and, for going on after an interruption,
/// training_state.safetensors to the folder; all of them whole or not at all. The same folders, options and
/// seed give the same bytes, resumed or not.
/// @param is_stopped  asked after each step: true ends the training with its state saved
/// @throws InputError if there is nothing to learn from, or the state in the folder is of another training
TrainingReport train(const TrainingConfig& config, const TrainingOptions& options,
                     const std::function<void(const TrainingProgress&)>& on_progress,
                     const std::function<bool()>& is_stopped);

}  // namespace mlo
