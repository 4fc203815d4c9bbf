// SPDX-License-Identifier: Apache-2.0
// Every body of functions.def.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/exponential.h"
