#include "schema/store/hdf5_handle.h"

namespace cairn::store {
namespace {

// HDF5 tidies up when the process exits, and after it has met a damaged file it complains on stderr that it
// cannot. There is nothing for it to tidy: every handle closes by itself and files are made in memory.
[[maybe_unused]] const bool kNothingAtExit = H5dont_atexit() >= 0;

// A file may ask for a filter that HDF5 would load as a library, from a folder that HDF5_PLUGIN_PATH names.
// Cairn's files need none.
[[maybe_unused]] const bool kNoPlugins = H5PLset_loading_state(0) >= 0;

// Walking downwards starts at the outermost call; the last one seen is where it went wrong.
herr_t Visit(unsigned, const H5E_error2_t* error, void* data) {
  auto* cause = static_cast<Hdf5Cause*>(data);
  cause->text = error->desc == nullptr ? "" : error->desc;
  cause->in_a_filter = cause->in_a_filter || error->maj_num == H5E_PLINE;
  cause->no_memory = cause->no_memory || (error->maj_num == H5E_RESOURCE &&
                                          (error->min_num == H5E_NOSPACE || error->min_num == H5E_CANTALLOC));
  return 0;
}

}  // namespace

Handle NumberType(DType type) {
  switch (type) {
    case DType::kU8:
      return {H5Tcopy(H5T_STD_U8LE), H5Tclose};
    case DType::kI32:
      return {H5Tcopy(H5T_STD_I32LE), H5Tclose};
    case DType::kI64:
      return {H5Tcopy(H5T_STD_I64LE), H5Tclose};
    case DType::kF32:
      return {H5Tcopy(H5T_IEEE_F32LE), H5Tclose};
    case DType::kF64:
      return {H5Tcopy(H5T_IEEE_F64LE), H5Tclose};
    case DType::kText:
      break;
  }
  return {};
}

std::mutex& LibraryMutex() {
  static std::mutex mutex;
  return mutex;
}

Hdf5Cause LastCause() {
  Hdf5Cause cause;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, Visit, &cause);
  if (cause.text.empty()) cause.text = "unknown cause";
  return cause;
}

}  // namespace cairn::store
