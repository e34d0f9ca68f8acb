#include "mlo/learning/training.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <numbers>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mlo/core/error.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/core/random.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/safetensors.hpp"
#include "mlo/learning/curves.hpp"
#include "mlo/learning/judge.hpp"
#include "mlo/learning/level_example.hpp"
#include "mlo/network/parameters.hpp"
#include "mlo/training/augmentation.hpp"
#include "mlo/training/example_source.hpp"
#include "mlo/training/object_bank.hpp"

namespace mlo {
namespace {

using ProgressCall = std::function<void(const TrainingProgress&)>;

constexpr std::size_t kListedWarnings = 10;
constexpr double kFirstRate = 0.1;   // of the largest, at the first step
constexpr double kLastRate = 0.002;  // and at the last
// Streams of random numbers.
constexpr std::uint64_t kOrderStream = 1;
constexpr std::uint64_t kAugmentationStream = 2;
constexpr std::uint64_t kBankStream = 3;

constexpr const char* kOwnerKey = "training";
constexpr const char* kCurvesTensor = "curves";

/// Indices of the scans that are used, folder by folder.
struct Selection {
  std::vector<std::unique_ptr<ExampleSource>> sources;
  std::vector<std::pair<std::size_t, std::size_t>> scans;  ///< source, index in it
};

Selection select(const std::vector<std::filesystem::path>& folders, std::size_t every,
                 std::size_t min_points) {
  Selection selection;
  for (const std::filesystem::path& folder : folders) {
    selection.sources.push_back(open_examples(folder, {.open = {}, .min_points = min_points}));
    for (std::size_t i = 0; i < selection.sources.back()->size(); i += every) {
      selection.scans.emplace_back(selection.sources.size() - 1, i);
    }
  }
  return selection;
}

std::vector<TrainingExample> load(const Selection& selection, const NetworkInputSpec& spec,
                                  const ProgressCall& on_progress, std::vector<std::string>& warnings) {
  std::vector<TrainingExample> examples;
  constexpr std::size_t kBlock = 16;  // scans that are in memory as they are
  for (std::size_t begin = 0; begin < selection.scans.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, selection.scans.size() - begin);
    std::vector<std::optional<TrainingExample>> block(count);
    std::vector<std::string> problems(count);
    parallel_for_each_index(count, [&](std::size_t k) {
      const auto [source, index] = selection.scans[begin + k];
      ExampleReading reading = selection.sources[source]->read(index);
      problems[k] = reading.problem;
      if (reading.example) block[k] = level(std::move(*reading.example), spec);
    });
    for (std::size_t k = 0; k < count; ++k) {
      if (block[k]) examples.push_back(std::move(*block[k]));
      if (!problems[k].empty() && warnings.size() < kListedWarnings) warnings.push_back(problems[k]);
    }
    on_progress({TrainingProgress::Phase::loading, begin + count, selection.scans.size(), {}});
  }
  return examples;
}

std::vector<std::size_t> shuffled_order(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  shuffle(order, seed);
  return order;
}

double learning_rate_at(long step, long steps, const TrainingConfig& config) {
  const double done = static_cast<double>(step) / static_cast<double>(std::max(1L, steps));
  if (done < config.warm_up) {
    return config.learning_rate * (kFirstRate + (1.0 - kFirstRate) * done / config.warm_up);
  }
  const double share = (done - config.warm_up) / (1.0 - config.warm_up);
  return config.learning_rate *
         (kLastRate + (1.0 - kLastRate) * 0.5 * (1.0 + std::cos(std::numbers::pi * share)));
}

void add(LossTerms& sum, const LossTerms& one, double weight) {
  sum.classes += weight * one.classes;
  sum.boxes += weight * one.boxes;
  sum.angles += weight * one.angles;
  sum.corners += weight * one.corners;
  sum.shifts += weight * one.shifts;
  sum.positives += weight * one.positives;
}

/// All values of a configuration as text.
struct Describer {
  std::string text = {};

  template <class T, class Check>
  void operator()(const std::string& name, const T& value, const Check&, const std::string&) {
    text += fmt::format("{}={} ", name, value);
  }
  template <class Group>
  void group(const std::string& name, Group& group, const std::string&) {
    text += name + ": ";
    group.fields(*this);
  }
};

// What has to be the same for a training to go on with the state of another.
std::string owner_of(TrainingConfig config, const TrainingOptions& options,
                     const NetworkArchitecture& architecture) {
  Describer describer;
  config.fields(describer);
  std::string text = describer.text + to_json(architecture);
  for (const std::filesystem::path& folder : options.folders) text += "\n" + folder.string();
  return text;
}

class Training {
 public:
  Training(const TrainingConfig& config, const TrainingOptions& options, const ProgressCall& on_progress)
      : config_(config),
        options_(options),
        on_progress_(on_progress),
        start_(options.start ? std::optional(read_safetensors(*options.start)) : std::nullopt),
        architecture_(start_ ? architecture_of(*start_) : small_architecture()),
        learner_(architecture_, static_cast<std::uint64_t>(config.seed),
                 {.weight_decay = config.weight_decay, .threads = config.torch_threads}),
        bank_({}, mix(static_cast<std::uint64_t>(config.seed), kBankStream)) {
    if (start_) learner_.begin_with(*start_);
  }

  TrainingReport run(const std::function<bool()>& is_stopped) {
    load_all();
    const std::size_t per_epoch =
        std::max<std::size_t>(1, examples_.size() / static_cast<std::size_t>(config_.batch));
    steps_ = static_cast<long>(per_epoch) * config_.epochs;
    if (options_.resume) restore();
    step_through(is_stopped);
    report_.steps = step_;
    if (!report_.interrupted) write_safetensors(options_.out / "weights.safetensors", learner_.weights());
    return std::move(report_);
  }

 private:
  void load_all() {
    const auto min_points = static_cast<std::size_t>(config_.min_points);
    const Selection chosen = select(options_.folders, static_cast<std::size_t>(config_.every), min_points);
    examples_ = load(chosen, architecture_.input, on_progress_, report_.warnings);
    if (examples_.empty()) {
      throw InputError("no scan can be learnt from: give folders with labels, and scans that see the ground");
    }
    for (const TrainingExample& example : examples_) bank_.add(example);
    Selection judged = select(options_.validation, 1, min_points);
    const std::size_t every = judged.scans.size() / std::max<std::size_t>(1, options_.max_validation) + 1;
    std::vector<std::pair<std::size_t, std::size_t>> some;
    for (std::size_t i = 0; i < judged.scans.size(); i += every) some.push_back(judged.scans[i]);
    judged.scans = std::move(some);
    validation_ = load(judged, architecture_.input, on_progress_, report_.warnings);
    report_.examples = examples_.size();
    report_.validation = validation_.size();
  }

  void step_through(const std::function<bool()>& is_stopped) {
    LossTerms sum;
    long summed = 0;
    std::future<std::vector<BatchExample>> next =
        std::async(std::launch::async, [this, s = step_] { return batch_of(s); });
    while (step_ < steps_) {
      const std::vector<BatchExample> batch = next.get();
      next = std::async(std::launch::async, [this, s = step_ + 1] { return batch_of(s); });
      const double rate = learning_rate_at(step_, steps_, config_);
      add(sum, learner_.step(batch, rate), 1.0);
      ++summed;
      ++step_;
      on_progress_({TrainingProgress::Phase::training,
                    static_cast<std::size_t>(step_),
                    static_cast<std::size_t>(steps_),
                    {}});
      const bool is_last = step_ == steps_;
      if (!is_last && is_stopped()) {
        // Not a line of the curves: a training that goes on must give the same as one that was never stopped.
        // It goes on from the last line.
        report_.interrupted = true;
        return;
      }
      if (!is_last && step_ % options_.validate_every != 0) continue;
      TrainingRow row{.step = step_, .loss = {}, .learning_rate = rate, .ap = {}};
      add(row.loss, sum, 1.0 / static_cast<double>(summed));
      sum = {};
      summed = 0;
      judge_and_save(std::move(row));
    }
  }

  void judge_and_save(TrainingRow row) {
    if (!validation_.empty()) {
      on_progress_({TrainingProgress::Phase::judging,
                    static_cast<std::size_t>(step_),
                    static_cast<std::size_t>(steps_),
                    {}});
      row.ap = judge(Network(learner_.weights()), validation_);
    }
    report_.rows.push_back(row);
    TensorFile state = learner_.state();
    state.metadata[kOwnerKey] = owner_of(config_, options_, architecture_);
    state.tensors[kCurvesTensor] = to_tensor(report_.rows);
    write_safetensors(options_.out / "training_state.safetensors", state);
    write_file_atomically(options_.out / "curves.csv", curves_csv(report_.rows, architecture_.classes));
    write_file_atomically(options_.out / "curves.svg", curves_svg(report_.rows, architecture_.classes));
    on_progress_({TrainingProgress::Phase::training, static_cast<std::size_t>(step_),
                  static_cast<std::size_t>(steps_), row});
  }

  void restore() {
    const std::filesystem::path file = options_.out / "training_state.safetensors";
    if (!std::filesystem::exists(file)) return;
    const TensorFile state = read_safetensors(file);
    const auto owner = state.metadata.find(kOwnerKey);
    if (owner == state.metadata.end() || owner->second != owner_of(config_, options_, architecture_)) {
      throw InputError(
          fmt::format("{}: it is of a training with other folders or settings; give the same as then, or "
                      "leave out --resume",
                      file.string()));
    }
    learner_.restore(state);
    const auto curves = state.tensors.find(kCurvesTensor);
    if (curves != state.tensors.end()) report_.rows = rows_from(curves->second);
    step_ = report_.rows.empty() ? 0 : report_.rows.back().step;
  }

  // What is drawn for a scan depends on seed and step alone.
  std::vector<BatchExample> batch_of(long step) const {
    const auto size = static_cast<std::size_t>(config_.batch);
    const auto seed = static_cast<std::uint64_t>(config_.seed);
    std::vector<BatchExample> batch(size);
    parallel_for_each_index(size, [&](std::size_t k) {
      const std::size_t number = static_cast<std::size_t>(step) * size + k;
      const std::uint64_t epoch = number / examples_.size();
      // The same for all scans of an epoch.
      const std::vector<std::size_t> order =
          shuffled_order(examples_.size(), mix(mix(seed, kOrderStream), epoch));
      const TrainingExample& example = examples_[order[number % examples_.size()]];
      TrainingExample changed =
          augment(example, bank_, config_.augmentation, mix(mix(seed, kAugmentationStream), number));
      shuffle(changed.points, number);
      batch[k] = make_batch_example(changed.points, target_boxes(changed, architecture_), architecture_);
    });
    return batch;
  }

  TrainingConfig config_;
  TrainingOptions options_;
  ProgressCall on_progress_;
  std::optional<TensorFile> start_;
  NetworkArchitecture architecture_;
  Learner learner_;
  ObjectBank bank_;
  std::vector<TrainingExample> examples_, validation_;
  TrainingReport report_;
  long step_ = 0;
  long steps_ = 0;
};

}  // namespace

AugmentationConfig all_round_augmentation() {
  AugmentationConfig augmentation;
  augmentation.max_rotation_deg = 180.0;
  augmentation.sampling.max_lift_m = 0.0;
  return augmentation;
}

TrainingReport train(const TrainingConfig& config, const TrainingOptions& options,
                     const ProgressCall& on_progress, const std::function<bool()>& is_stopped) {
  std::filesystem::create_directories(options.out);
  return Training(config, options, on_progress).run(is_stopped);
}

}  // namespace mlo
