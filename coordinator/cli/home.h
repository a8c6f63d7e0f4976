// Where a coordinator and its clients meet when nobody says otherwise: the folder ~/.cairn, which nobody else
// may enter.
#pragma once

#include <string>

namespace cairn::cli {

// $CAIRN_HOME, else $HOME/.cairn, made with mode 0700 where it is missing. Throws InputError where neither is
// set.
std::string HomeFolder();

// $CAIRN_COORDINATOR, else the ipc endpoint in HomeFolder().
std::string DefaultEndpoint();

}  // namespace cairn::cli
