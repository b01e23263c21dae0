// SPDX-License-Identifier: Apache-2.0
// Included before every source of a room: an identifier of a foreign library that the room does not name under FOREIGN in its
// component's CMakeLists.txt is an error. Include roots alone cannot do this, as Debian's headers all lie in /usr/include.
#ifndef SUBVOL_FOREIGN_CAIRO
#pragma GCC poison cairo_create
#endif
#ifndef SUBVOL_FOREIGN_CERES
#pragma GCC poison ceres
#endif
#ifndef SUBVOL_FOREIGN_CLI11
#pragma GCC poison CLI11_PARSE
#endif
#ifndef SUBVOL_FOREIGN_EIGEN
#pragma GCC poison Eigen
#endif
#ifndef SUBVOL_FOREIGN_EMBREE
#pragma GCC poison RTCDevice RTCScene
#endif
#ifndef SUBVOL_FOREIGN_EPOXY
#pragma GCC poison GLuint EGLDisplay
#endif
#ifndef SUBVOL_FOREIGN_HIGHWAY
#pragma GCC poison hwy
#endif
#ifndef SUBVOL_FOREIGN_JSON
#pragma GCC poison nlohmann
#endif
#ifndef SUBVOL_FOREIGN_LZ4
#pragma GCC poison LZ4_decompress_safe
#endif
#ifndef SUBVOL_FOREIGN_LZMA
#pragma GCC poison lzma_stream
#endif
#ifndef SUBVOL_FOREIGN_MUPARSER
#pragma GCC poison ParserBase
#endif
#ifndef SUBVOL_FOREIGN_NANOVDB
#pragma GCC poison nanovdb
#endif
#ifndef SUBVOL_FOREIGN_OPENIMAGEIO
#pragma GCC poison OIIO_VERSION
#endif
#ifndef SUBVOL_FOREIGN_OPENVDB
#pragma GCC poison openvdb
#endif
#ifndef SUBVOL_FOREIGN_PUGIXML
#pragma GCC poison pugi
#endif
#ifndef SUBVOL_FOREIGN_ZLIB
#pragma GCC poison z_stream
#endif
