// SPDX-License-Identifier: Apache-2.0
// Every body of the fast and the precise tier.
#pragma once

#include "compiler/functions/fast_color.h"
#include "compiler/functions/fast_exponential.h"
#include "compiler/functions/fast_trigonometric.h"
#include "compiler/functions/fast_vector.h"
#include "compiler/functions/precise_color.h"
#include "compiler/functions/precise_exponential.h"
#include "compiler/functions/precise_trigonometric.h"
#include "compiler/functions/precise_vector.h"
