// A study's inputs as its job names them.
#pragma once

#include <map>
#include <string>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::datasets {

// Each by its name, a file of the folder inputs/, by its content without the truth.
inline void NameInputs(const std::map<std::string, Blob>& inputs, proto::Job* job) {
  for (const auto& [name, blob] : inputs) {
    (*job->mutable_inputs())[name] = "inputs/" + name + ".h5";
    (*job->mutable_input_blobs())[name] = blob.Without("truth/").ContentHash().Binary();
  }
}

}  // namespace cairn::datasets
