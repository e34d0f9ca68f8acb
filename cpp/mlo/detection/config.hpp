#pragma once

#include <string>
#include <vector>

#include "mlo/core/fields.hpp"

namespace mlo {

/// What the scan before says of this one's boxes, consistency.hpp.
struct RecurrenceConfig {
  double share = 0.5;
  double new_loses = 1.0;
  double within_m = 2.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit(
        "share", share, between(0.0, 0.99),
        "of the log-odds that a box had in the scan before, added to those of this one; more trusts what is "
        "seen again and again, and is slower to see that it is nothing");
    visit("new_loses", new_loses, between(0.0, 10.0), "log-odds taken from a box that was not there before");
    visit("within_m", within_m, between(0.1, 20.0),
          "from scan to scan a box moves less than this over the ground [m]");
  }
};

/// The detector without a network, cluster_detector.hpp.
struct ClusterConfig {
  double min_probability = 0.5;
  double min_candidate = 0.1;
  double reach_m = 70.0;
  double cell_m = 0.2;
  double min_height_m = 0.2;
  double max_height_m = 2.6;
  std::vector<double> gaps_m = {0.2, 0.4, 0.8};
  double gap_growth = 0.01;
  int min_points = 6;
  double max_shared = 0.1;
  RecurrenceConfig recurrence;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("min_probability", min_probability, between(0.0, 1.0),
          "objects that are less probable are not reported; lower finds more, and takes more of the "
          "surroundings "
          "away from the localisation");
    visit("min_candidate", min_candidate, between(0.0, 1.0),
          "objects this probable by one scan alone are remembered, and may grow sure by the next");
    visit("reach_m", reach_m, between(5.0, 200.0), "objects are looked for up to this distance [m]");
    visit("cell_m", cell_m, between(0.05, 1.0), "side of the cells that points are clustered by [m]");
    visit("min_height_m", min_height_m, between(0.0, 2.0),
          "points nearer to the ground than this belong to no object [m]");
    visit("max_height_m", max_height_m, between(0.5, 10.0),
          "points higher above the ground do not connect what is below: crowns of trees over cars [m]");
    visit("gaps_m", gaps_m, between(0.0, 5.0),
          "largest gaps within a cluster, each tried in turn: small ones part neighbours, large ones bridge "
          "what is seen in pieces [m]");
    visit("gap_growth", gap_growth, between(0.0, 0.1),
          "growth of these gaps per metre of range, as returns get sparse [m/m]");
    visit("min_points", min_points, between(3, 1000), "a cluster has at least so many points");
    visit("max_shared", max_shared, between(0.0, 1.0),
          "of two boxes that share more of their ground area (intersection over union) the less sure one is "
          "dropped");
    visit.group("recurrence", recurrence, "What the scan before says of the boxes of this one.");
  }
};

/// The detector with a network, network_detector.hpp.
struct NetworkConfig {
  std::string weights;
  double min_confidence = 0.3;
  double min_candidate = 0.05;
  double max_shared = 0.1;
  RecurrenceConfig recurrence;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("weights", weights, Anything{},
          "file of the network (.safetensors), from 'mlo train' or scripts/convert_3dssd_checkpoint.py; "
          "empty: the "
          "one that comes with mlo");
    visit(
        "min_confidence", min_confidence, between(0.0, 1.0),
        "objects that the network is less sure of are not reported; lower finds more, and takes more of the "
        "surroundings away from the localisation");
    visit("min_candidate", min_candidate, between(0.0, 1.0),
          "objects this sure by one scan alone are remembered, and may grow sure by the next");
    visit("max_shared", max_shared, between(0.0, 1.0),
          "of two boxes that share more of their ground area (intersection over union) the less sure one is "
          "dropped");
    visit.group("recurrence", recurrence, "What the scan before says of the boxes of this one.");
  }
};

/// What finds the boxes where none are given.
enum class Detector { none, cluster, network };

/// All of detection.
struct DetectionConfig {
  Detector detector = Detector::cluster;
  ClusterConfig cluster;
  NetworkConfig network;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("detector", detector,
          Choices<Detector>{
              {"none", Detector::none}, {"cluster", Detector::cluster}, {"3dssd", Detector::network}},
          "finds the objects where no boxes are given: none; cluster, which needs no network; 3dssd, a "
          "network");
    visit.group("cluster", cluster, "The detector without a network.");
    visit.group("network", network, "The detector with a network, 3dssd.");
  }
};

}  // namespace mlo
