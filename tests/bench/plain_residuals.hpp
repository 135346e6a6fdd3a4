// Residuals of n cubics, columns x0 y0 .. x3 y3, by 24 nodes and no bound, by instruction set.
#pragma once

#include <stddef.h>

void plain_residuals_baseline(const double* const* in, double* e, size_t n);
void plain_residuals_avx2(const double* const* in, double* e, size_t n);
void plain_residuals_avx512(const double* const* in, double* e, size_t n);
