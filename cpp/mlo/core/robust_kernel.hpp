#pragma once

namespace mlo {

/// Weight of a squared residual by Geman and McClure's kernel, in iteratively reweighted least squares: 1 at
/// 0, a quarter at the scale. Residual and scale in the same unit.
inline double geman_mcclure_weight(double squared_residual, double scale) {
  const double squared_scale = scale * scale;
  const double ratio = squared_scale / (squared_scale + squared_residual);
  return ratio * ratio;
}

}  // namespace mlo
