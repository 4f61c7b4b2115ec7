// Every technique, with options that take other ways through its stages.
#pragma once

namespace beampipe {

inline constexpr const char* kManySpecs[] = {
    "beam",
    "beam:bits=64,slots=4,at=visible",
    "beam:bits=32,slots=2,bin=8,at=quarters",
    "beam:order=sorted",
    "beam:order=sorted,storage=float32",
    "casav:mask=exact",
    "casav:storage=text",
    "casav:sort=nearest,tiny=3,overlap=transition,regional=area,local=keep,fuzzy=mix,extents=slab,"
    "slab=visible,plane=visible,thickness=containing",
    "casav:order=near-first",
    "casav:order=stream,layers=2",
    "beam:order=stream",
    "z3",
    "z3:shape=128x3",
    "alpha",
    "msaa:1",
    "msaa:8",
    "msaa:64",
    "reference",
    "msaa:8,prepass",
    "acaa:8",
    "acaa:64,double=stencil,color=unorm8",
    "deferred",
    "visibility",
    "visibility:8",
    "msaa:4,motion,resolve=reinhard",
    "taa:8",
    "taa:8,shading=forward",
    "taa:8,shading=deferred",
    "dvm",
    "dvm:material=draw"};

}  // namespace beampipe
