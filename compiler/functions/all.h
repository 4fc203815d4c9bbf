// SPDX-License-Identifier: Apache-2.0
// The bodies of all functions in all tiers, at all widths.
#pragma once

#include "compiler/functions/blending.h"
#include "compiler/functions/cell.h"
#include "compiler/functions/color.h"
#include "compiler/functions/comparison.h"
#include "compiler/functions/exact.h"
#include "compiler/functions/exponential.h"
#include "compiler/functions/fast.h"
#include "compiler/functions/feature_points.h"
#include "compiler/functions/inverse_trigonometric.h"
#include "compiler/functions/logarithm.h"
#include "compiler/functions/matrix.h"
#include "compiler/functions/noise.h"
#include "compiler/functions/power.h"
#include "compiler/functions/precise.h"
#include "compiler/functions/rounding.h"
#include "compiler/functions/texture.h"
#include "compiler/functions/trigonometric.h"
#include "compiler/functions/vector.h"
#include "compiler/functions/widths.h"
