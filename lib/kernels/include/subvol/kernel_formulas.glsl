// SPDX-License-Identifier: Apache-2.0
// The kernels' formulas, once for C++ and GLSL: only what both languages read the same way.
//
// The including file defines `real`, `real3` and `real4` and supplies `real kernel_table(int i)`, the kernel's table.
// Callers use kernel_radial, kernel_value and kernel_gradient at the end; `type` and `p` are a KernelCode's type and parameters.

#define KERNEL_COMPACT 0             // p: radius
#define KERNEL_GAUSSIAN 1            // p: radius, sigma, amplitude
#define KERNEL_GAUSSIAN_SUM 2        // p: radius, count; table: the amplitudes, then the sigmas
#define KERNEL_CUBIC 3               // p: extent, B, C
#define KERNEL_WENDLAND_C2 4         // p: radius, amplitude
#define KERNEL_WENDLAND_C4 5         // p: radius, amplitude
#define KERNEL_SEPARABLE_GAUSSIAN 6  // p: radius, sigma, a, b; from here on the kernels are not radial
#define KERNEL_SEPARABLE_CUBIC 7     // p: extent, B, C
#define KERNEL_SEPARABLE_TABLE 8     // p: radius, count; table: the values
#define KERNEL_TABLE 9               // p: radius, count; table: count^3 values, x fastest

// Coefficients of 1, t, t^2, t^3 of Mitchell and Netravali's cubic: its inner and its outer piece.
real4 kernel_cubic_inner(real b, real c) {
    return real4(1.0 - b / 3.0, 0.0, -3.0 + 2.0 * b + c, 2.0 - 1.5 * b - c);
}

real4 kernel_cubic_outer(real b, real c) {
    return real4(4.0 / 3.0 * b + 4.0 * c, -2.0 * b - 8.0 * c, b + 5.0 * c, -b / 6.0 - c);
}

real4 kernel_cubic_piece(real t, real4 p) {
    return t < 0.5 * p.x ? kernel_cubic_inner(p.y, p.z) : kernel_cubic_outer(p.y, p.z);
}

real kernel_cubic(real t, real4 p) {
    real4 k = kernel_cubic_piece(t, p);
    return k.x + t * (k.y + t * (k.z + t * k.w));
}

real kernel_gaussian(real t, real sigma) {
    return exp(-0.5 * t * t / (sigma * sigma));
}

// A radial kernel at a distance rho.
real kernel_radial(int type, real4 p, real rho) {
    if (rho >= p.x) return 0.0;
    real s = rho / p.x, left = 1.0 - s, left2 = left * left;
    if (type == KERNEL_COMPACT) {
        real u = 1.0 - s * s;
        return u * u * u;
    }
    if (type == KERNEL_GAUSSIAN) return p.z * kernel_gaussian(rho, p.y);
    if (type == KERNEL_GAUSSIAN_SUM) {
        int count = int(p.y);
        real sum = 0.0;
        for (int i = 0; i < count; ++i) sum += kernel_table(i) * kernel_gaussian(rho, kernel_table(count + i));
        return sum;
    }
    if (type == KERNEL_CUBIC) return kernel_cubic(rho, p);
    if (type == KERNEL_WENDLAND_C2) return p.y * left2 * left2 * (4.0 * s + 1.0);
    if (type == KERNEL_WENDLAND_C4) return p.y * left2 * left2 * left2 * (s * (35.0 * s + 18.0) + 3.0) / 3.0;
    return 0.0;
}

// The derivative of a radial kernel over rho: times x it is the gradient. Finite at rho = 0.
real kernel_radial_slope(int type, real4 p, real rho) {
    if (rho >= p.x) return 0.0;
    real s = rho / p.x, left = 1.0 - s, left3 = left * left * left;
    if (type == KERNEL_COMPACT) {
        real u = 1.0 - s * s;
        return -6.0 * u * u / (p.x * p.x);
    }
    if (type == KERNEL_GAUSSIAN) return -p.z / (p.y * p.y) * kernel_gaussian(rho, p.y);
    if (type == KERNEL_GAUSSIAN_SUM) {
        int count = int(p.y);
        real sum = 0.0;
        for (int i = 0; i < count; ++i) {
            real sigma = kernel_table(count + i);
            sum -= kernel_table(i) / (sigma * sigma) * kernel_gaussian(rho, sigma);
        }
        return sum;
    }
    if (type == KERNEL_CUBIC) {
        real4 k = kernel_cubic_piece(rho, p);
        return 2.0 * k.z + 3.0 * k.w * rho + (k.y != 0.0 ? k.y / rho : 0.0);
    }
    if (type == KERNEL_WENDLAND_C2) return -20.0 * p.y * left3 / (p.x * p.x);
    if (type == KERNEL_WENDLAND_C4) return -56.0 / 3.0 * p.y * left3 * left * left * (5.0 * s + 1.0) / (p.x * p.x);
    return 0.0;
}

// The number of the interval of a table that contains t in [0,radius); kernel_place: how far t is into it, in [0,1].
int kernel_interval(real t, real4 p) {
    return min(int(t / p.x * (p.y - 1.0)), int(p.y) - 2);
}

real kernel_place(real t, real4 p) {
    return t / p.x * (p.y - 1.0) - real(kernel_interval(t, p));
}

// One factor of a separable kernel at t >= 0.
real kernel_factor(int type, real4 p, real t) {
    if (t >= p.x) return 0.0;
    if (type == KERNEL_SEPARABLE_GAUSSIAN) return (p.z + p.w * t * t) * kernel_gaussian(t, p.y);
    if (type == KERNEL_SEPARABLE_CUBIC) return kernel_cubic(t, p);
    int i = kernel_interval(t, p);
    real f = kernel_place(t, p);
    return (1.0 - f) * kernel_table(i) + f * kernel_table(i + 1);
}

// The factor's derivative at t >= 0.
real kernel_factor_slope(int type, real4 p, real t) {
    if (t >= p.x) return 0.0;
    if (type == KERNEL_SEPARABLE_GAUSSIAN) {
        return t * (2.0 * p.w - (p.z + p.w * t * t) / (p.y * p.y)) * kernel_gaussian(t, p.y);
    }
    if (type == KERNEL_SEPARABLE_CUBIC) {
        real4 k = kernel_cubic_piece(t, p);
        return k.y + t * (2.0 * k.z + 3.0 * k.w * t);
    }
    int i = kernel_interval(t, p);
    return (kernel_table(i + 1) - kernel_table(i)) * (p.y - 1.0) / p.x;
}

// A table's value (order 0) or its derivative along axis x, y, z (order 1, 2, 3) at a place in the octant [0,radius)^3.
real kernel_trilinear(real4 p, real x, real y, real z, int order) {
    int n = int(p.y);
    int i = kernel_interval(x, p), j = kernel_interval(y, p), k = kernel_interval(z, p);
    real u = kernel_place(x, p), v = kernel_place(y, p), w = kernel_place(z, p), step = (p.y - 1.0) / p.x, sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        int a = corner % 2, b = corner / 2 % 2, c = corner / 4;
        real weight_x = order == 1 ? (a == 1 ? step : -step) : (a == 1 ? u : 1.0 - u);
        real weight_y = order == 2 ? (b == 1 ? step : -step) : (b == 1 ? v : 1.0 - v);
        real weight_z = order == 3 ? (c == 1 ? step : -step) : (c == 1 ? w : 1.0 - w);
        sum += weight_x * weight_y * weight_z * kernel_table(i + a + n * (j + b + n * (k + c)));
    }
    return sum;
}

// Any kernel at an offset.
real kernel_value(int type, real4 p, real3 at) {
    if (type < KERNEL_SEPARABLE_GAUSSIAN) return kernel_radial(type, p, sqrt(at.x * at.x + at.y * at.y + at.z * at.z));
    real x = abs(at.x), y = abs(at.y), z = abs(at.z);
    if (x >= p.x || y >= p.x || z >= p.x) return 0.0;
    if (type == KERNEL_TABLE) return kernel_trilinear(p, x, y, z, 0);
    return kernel_factor(type, p, x) * kernel_factor(type, p, y) * kernel_factor(type, p, z);
}

// Its gradient; at a kink that of the outer piece, across a plane of symmetry 0.
real3 kernel_gradient(int type, real4 p, real3 at) {
    if (type < KERNEL_SEPARABLE_GAUSSIAN) {
        return kernel_radial_slope(type, p, sqrt(at.x * at.x + at.y * at.y + at.z * at.z)) * at;
    }
    real x = abs(at.x), y = abs(at.y), z = abs(at.z);
    real3 side = real3(sign(at.x), sign(at.y), sign(at.z));
    if (x >= p.x || y >= p.x || z >= p.x) return real3(0.0, 0.0, 0.0);
    if (type == KERNEL_TABLE) {
        return side * real3(kernel_trilinear(p, x, y, z, 1), kernel_trilinear(p, x, y, z, 2), kernel_trilinear(p, x, y, z, 3));
    }
    real fx = kernel_factor(type, p, x), fy = kernel_factor(type, p, y), fz = kernel_factor(type, p, z);
    return side * real3(kernel_factor_slope(type, p, x) * fy * fz, fx * kernel_factor_slope(type, p, y) * fz,
                        fx * fy * kernel_factor_slope(type, p, z));
}
