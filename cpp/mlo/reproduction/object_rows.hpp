#pragma once

#include "mlo/reproduction/find_data.hpp"
#include "mlo/reproduction/reproduce.hpp"

namespace mlo {

/// A row of Table IV, named by drive and object ("0926-0009 87"): the object's errors by variant, a run of
/// the drive with PointRCNN's cars each. Truth are the drive's annotations (tracklets, or the labels of its
/// tracking sequence; the numbers of the objects are the same) in the smoothed poses of its inertial records.
/// An object that a variant lost has no errors.
/// @throws InputError when data that is there cannot be used
ReproducedRow object_row(const PaperTable& table, const PaperRow& row, const KittiData& data,
                         const ReproduceOptions& options, const ReproduceProgress& progress);

}  // namespace mlo
