// A result of localization made by hand, for tests.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// A run of four samples, 1 m apart.
inline Blob LocalizedSamples() {
  Blob file;
  file.Put("runs", Array::Texts({"there"}));
  file.Put("input_name", Array::Texts({"input0"}));
  file.PutVector<double>("run/0/time_s", {0, 1, 2, 3});
  file.PutVector<double>("run/0/x_m", {0, 1, 2, 3});
  file.PutVector<double>("run/0/y_m", {0, 0, 0, 0});
  file.Put("run/0/input", Array::Of<float>({4, 1}, std::vector<float>(4, 0.0F)));
  return file;
}

// Two traverses of it, of two sensations and of one: from sample 0 on, half sure of 1 and 2 m, then sure of 2
// m; from sample 1 on, sure of 2 m.
inline Blob LocalizationFile() {
  Blob file;
  file.PutVector<std::int32_t>("step/traverse", {0, 0, 0, 1, 1});
  file.PutVector<std::int32_t>("step/run", {0, 0, 0, 0, 0});
  file.PutVector<std::int32_t>("step/sample", {0, 1, 2, 1, 2});
  file.PutVector<double>("step/travelled_m", {0, 1, 2, 0, 1});
  file.PutVector<double>("step/mean_x_m", {1.5, 1.5, 2, 1.5, 2});
  file.PutVector<double>("step/mean_y_m", {0, 0, 0, 0, 0});
  file.PutVector<double>("step/mode_x_m", {0, 1, 2, 0, 2});
  file.PutVector<double>("step/mode_y_m", {0, 0, 0, 0, 0});
  file.PutVector<double>("step/spread_m", {1.1, 0.5, 0, 1.1, 0});
  file.PutVector<std::int64_t>("step/entries", {4, 2, 1, 4, 1});
  file.PutVector<std::int32_t>("belief/position", {0, 1, 2, 3, 1, 2, 2, 0, 1, 2, 3, 2});
  file.PutVector<float>("belief/probability",
                        {.25F, .25F, .25F, .25F, .5F, .5F, 1, .25F, .25F, .25F, .25F, 1});
  file.PutVector<double>("position/x_m", {0, 1, 2, 3});
  file.PutVector<double>("position/y_m", {0, 0, 0, 0});
  file.Put("runs", Array::Texts({"there"}));
  file.Put("feature_name", Array::Texts({"door"}));
  file.Put("samples_hash", Array::Text(LocalizedSamples().ContentHash().Hex()));
  file.PutScalar("window_m", 0.0);
  return file;
}

}  // namespace cairn::datasets
