"""Builds the wheel and the sdist of the package (PEP 517). CMake builds the module and installs the component `python`.

pip wheel . --config-settings=build=FOLDER takes the module from a build folder that is built already.
"""
import base64
import gzip
import hashlib
import io
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DATE = (1980, 1, 1, 0, 0, 0)  # of all files, so that the same build gives the same bytes; zip knows no earlier one


def _project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _version():
    return re.search(r"project\(beampipe VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def _metadata():
    project = _project()
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {_version()}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {need}" for need in project["dependencies"]]
    for extra, needs in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}"] + [f'Requires-Dist: {need}; extra == "{extra}"' for need in needs]
    return "\n".join(lines + ["", (ROOT / "README.md").read_text(encoding="utf-8")])


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _run(*command):
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def _build(folder):
    _run("cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DBEAMPIPE_TESTS=OFF", "-DBEAMPIPE_PYTHON=ON",
         f"-DPython3_EXECUTABLE={sys.executable}")
    _run("cmake", "--build", folder, "--target", "beampipe_python", "--parallel", os.cpu_count() or 1)


def _package_files(build):
    """The package's files by their names in the wheel, as CMake installs them."""
    with tempfile.TemporaryDirectory() as prefix:
        _run("cmake", "--install", build, "--component", "python", "--prefix", prefix, "--strip")
        module, = pathlib.Path(prefix).rglob("beampipe/_native.*.so")
        root = module.parent.parent
        return {str(file.relative_to(root)): file.read_bytes() for file in sorted(root.rglob("*")) if file.is_file()}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with tempfile.TemporaryDirectory() as scratch:
        build = (config_settings or {}).get("build")
        if not build:
            build = pathlib.Path(scratch) / "build"
            _build(build)
        files = _package_files(build)
    stem = f"beampipe-{_version()}"
    about = f"{stem}.dist-info"
    files[f"{about}/METADATA"] = _metadata().encode()
    files[f"{about}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{about}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: beampipe\nRoot-Is-Purelib: false\nTag: {_tag()}\n").encode()
    record = "".join(f"{name},sha256={_digest(data)},{len(data)}\n" for name, data in files.items())
    files[f"{about}/RECORD"] = (record + f"{about}/RECORD,,\n").encode()
    name = f"{stem}-{_tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for file, data in files.items():
            info = zipfile.ZipInfo(file, DATE)
            info.external_attr, info.compress_type = 0o100644 << 16, zipfile.ZIP_DEFLATED
            wheel.writestr(info, data)
    return name


def _digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def build_sdist(sdist_directory, config_settings=None):
    """All files that Git knows."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    stem = f"beampipe-{_version()}"
    name = f"{stem}.tar.gz"
    with open(pathlib.Path(sdist_directory) / name, "wb") as stream, gzip.GzipFile("", "wb", fileobj=stream, mtime=0) as packed, \
            tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
        for file in filter(None, listed.split("\0")):
            if (ROOT / file).is_file():
                _add(archive, f"{stem}/{file}", (ROOT / file).read_bytes(), (ROOT / file).stat().st_mode & 0o777)
        _add(archive, f"{stem}/PKG-INFO", _metadata().encode(), 0o644)
    return name


def _add(archive, name, data, mode):
    info = tarfile.TarInfo(name)
    info.size, info.mode = len(data), mode
    archive.addfile(info, io.BytesIO(data))
