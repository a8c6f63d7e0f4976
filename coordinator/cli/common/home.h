// Where a coordinator and its clients meet when nobody says otherwise: the folder ~/.cairn, which nobody else
// may enter.
#pragma once

#include <string>

namespace cairn::cli {

// $CAIRN_HOME, else $HOME/.cairn, made with mode 0700 where it is missing.
// Throws InputError where neither is set.
std::string HomeFolder();

// Where keys lie: $XDG_CONFIG_HOME/cairn, else $HOME/.config/cairn. Not made here.
// Throws InputError where neither is set.
std::string ConfigFolder();
// A file in there.
// Throws InputError, with what to do, where it is missing.
std::string DefaultKey(const std::string& file);

// $CAIRN_COORDINATOR, else the ipc endpoint in HomeFolder().
std::string DefaultEndpoint();

}  // namespace cairn::cli
