#!/bin/bash -eu
# SPDX-License-Identifier: Apache-2.0
# Builds all fuzzers into $OUT, each with its first inputs and the libraries that it loads.
cmake --preset fuzz -DSUBVOL_VDB=OFF -DSUBVOL_RENDER=OFF -DSUBVOL_VIEW=OFF -DSUBVOL_COMPARE=OFF -DSUBVOL_CLI=OFF -DSUBVOL_HDF5=OFF
cmake --build --preset fuzz
mkdir -p "$OUT/lib" build/fuzz/corpus
build/fuzz/fuzz/fuzz_seeds build/fuzz/corpus
for fuzzer in build/fuzz/fuzz/fuzz_*; do
    name=$(basename "$fuzzer")
    [ -f "$fuzzer" ] && [ -x "$fuzzer" ] && [ "$name" != fuzz_seeds ] || continue
    cp "$fuzzer" "$OUT/"
    ldd "$fuzzer" | sed -n 's|.* => \(/[^ ]*\) .*|\1|p' | grep -v '/lib\(c\|m\|dl\|rt\|pthread\|gcc_s\)\.so' | xargs -r -I{} cp -n {} "$OUT/lib/"
    patchelf --set-rpath '$ORIGIN/lib' "$OUT/$name"
    corpus=build/fuzz/corpus/${name#fuzz_}
    [ ! -d "$corpus" ] || zip -q -j -r "$OUT/${name}_seed_corpus.zip" "$corpus"
done
