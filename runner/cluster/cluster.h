// jnd cluster: a power study on a cluster's scheduler.
#pragma once

#include "runner/terminal/command_tree.h"

namespace jnd {

void add_cluster(CommandTree& tree);

}  // namespace jnd
