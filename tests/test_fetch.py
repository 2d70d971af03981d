"""Fetching public sets, against a web server on this machine."""

import functools
import hashlib
import io
import tarfile
import threading
import zipfile
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import IO
from urllib.parse import urlparse

import pytest

from horizon_dl.download import download as download_module
from horizon_dl.download import public_sets as registry
from horizon_dl.download.fetch import SUMS, fetch
from horizon_dl.download.public_sets import Archive, PublicSet, list_sets
from horizon_dl.download.unpack import unpack
from horizon_dl.errors import InputError


class Handler(SimpleHTTPRequestHandler):
    """Serves files; `/short/NAME` promises a hundred bytes more than it sends."""

    def log_message(self, *_: object) -> None:
        pass

    def do_GET(self) -> None:
        if not self.path.startswith("/short/"):
            return super().do_GET()
        body = (Path(self.directory) / self.path.removeprefix("/short/")).read_bytes()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body) + 100))
        self.end_headers()
        self.wfile.write(body)
        return None


@pytest.fixture
def served(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """A folder and the address that serves it."""
    folder = tmp_path / "served"
    folder.mkdir()
    server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield folder, f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()
    thread.join()


def zip_bytes(members: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as zipped:
        for name, content in members.items():
            zipped.writestr(name, content)
    return stream.getvalue()


def tar_bytes(members: dict[str, bytes], link: tuple[str, str] | None = None) -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as tar:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            tar.addfile(info, io.BytesIO(content))
        if link:
            info = tarfile.TarInfo(link[0])
            info.type, info.linkname = tarfile.SYMTYPE, link[1]
            tar.addfile(info)
    return stream.getvalue()


def know(monkeypatch: pytest.MonkeyPatch, *archives: Archive, opens: str = ".") -> None:
    known = PublicSet("toy", "a toy", "free", "https://example.org/toy", archives, 1, opens)
    monkeypatch.setattr(registry, "_SETS", (known,))


def left_in(out: Path) -> list[str]:
    return sorted(path.name for path in out.iterdir()) if out.exists() else []


def test_registry_is_official_and_well_formed() -> None:
    hosts = {"s3.eu-central-1.amazonaws.com", "cvg.cit.tum.de", "www.research-collection.ethz.ch"}
    names = [known.name for known in list_sets()]
    assert len(set(names)) == len(names) >= 6
    for known in list_sets():
        assert known.licence
        for archive in known.archives:
            assert urlparse(archive.url).scheme == "https"
            assert urlparse(archive.url).hostname in hosts
            assert archive.file.endswith((".zip", ".tgz"))
            assert archive.sha256 is None or len(bytes.fromhex(archive.sha256)) == 32


def test_unknown_name_and_the_simulated_set(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="take one of simulated, kitti-0001"):
        fetch("kiti", tmp_path)
    with pytest.raises(InputError, match="data simulate"):
        fetch("simulated", tmp_path)


def test_fetches_several_archives_into_one_set(
    served: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, address = served
    (folder / "calib.zip").write_bytes(zip_bytes({"day/calib.txt": b"c"}))
    content = tar_bytes({"day/drive/image.png": b"i" * 700_000})
    (folder / "drive.tgz").write_bytes(content)
    digest = hashlib.sha256(content).hexdigest()
    know(
        monkeypatch,
        Archive("https://no.example/x", "calib.zip"),
        Archive("https://no.example/y", "drive.tgz", digest),
        opens="day/drive",
    )
    said: list[str] = []
    out = tmp_path / "sets"
    opened = fetch("toy", out, base_url=address, say=said.append)
    assert opened == out / "toy" / "day" / "drive"
    assert (opened / "image.png").stat().st_size == 700_000
    assert (opened.parent / "calib.txt").read_bytes() == b"c"
    assert left_in(out) == [SUMS, "toy"]
    assert len(said) == 1
    assert "no published hash" in said[0]
    assert f"{digest}  drive.tgz" in (out / SUMS).read_text()
    assert fetch("toy", out, base_url="http://127.0.0.1:9", say=said.append) == opened  # not downloaded again
    assert "there already" in said[1]


def test_a_hash_on_record_must_be_met_again(
    served: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, address = served
    know(monkeypatch, Archive("https://no.example/x", "a.zip"))
    (folder / "a.zip").write_bytes(zip_bytes({"f": b"1"}))
    out = tmp_path / "sets"
    fetch("toy", out, base_url=address, say=lambda _: None)
    (out / "toy" / "f").unlink()
    (out / "toy").rmdir()
    (folder / "a.zip").write_bytes(zip_bytes({"f": b"2"}))
    with pytest.raises(InputError, match="has SHA-256"):
        fetch("toy", out, base_url=address)
    assert left_in(out) == [SUMS]


def test_wrong_hash_leaves_nothing(
    served: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, address = served
    (folder / "a.zip").write_bytes(zip_bytes({"f": b"1"}))
    know(monkeypatch, Archive("https://no.example/x", "a.zip", "0" * 64))
    with pytest.raises(InputError, match=f"instead of {'0' * 64}"):
        fetch("toy", tmp_path / "sets", base_url=address)
    assert not (tmp_path / "sets").exists()


@pytest.mark.parametrize(
    ("path", "says"), [("", "404"), ("/short", "broke off after"), ("refused", "cannot be reached")]
)
def test_transfers_that_fail(
    path: str, says: str, served: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, address = served
    (folder / "here.zip").write_bytes(zip_bytes({"f": b"1"}))
    know(monkeypatch, Archive("https://no.example/x", "here.zip" if path else "gone.zip"))
    base = "http://127.0.0.1:9" if path == "refused" else address + path
    with pytest.raises(InputError, match=says) as caught:
        fetch("toy", tmp_path / "sets", base_url=base)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "sets").exists()


def test_full_disk(served: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, address = served
    (folder / "a.zip").write_bytes(zip_bytes({"f": b"1"}))
    know(monkeypatch, Archive("https://no.example/x", "a.zip"))

    def full(*_: object) -> IO[bytes]:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(download_module, "_stream", full)
    with pytest.raises(InputError, match="No space left on device"):
        fetch("toy", tmp_path / "sets", base_url=address)
    assert not (tmp_path / "sets").exists()


def test_set_nested_in_a_collection(
    served: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, address = served
    inner = zip_bytes({"mav0/cam0/data.csv": b"1"})
    (folder / "all.zip").write_bytes(zip_bytes({"hall/one/one.zip": inner, "hall/two/two.zip": b"other"}))
    know(monkeypatch, Archive("https://no.example/x", "all.zip", inside="one.zip"))
    opened = fetch("toy", tmp_path / "sets", base_url=address, say=lambda _: None)
    assert [str(path.relative_to(opened)) for path in opened.rglob("*.csv")] == ["mav0/cam0/data.csv"]
    know(monkeypatch, Archive("https://no.example/x", "all.zip", inside="three.zip"))
    with pytest.raises(InputError, match=r"holds no three\.zip"):
        fetch("toy", tmp_path / "more", base_url=address)


@pytest.mark.parametrize(
    ("file", "content"),
    [
        ("up.zip", zip_bytes({"../evil.txt": b"x"})),
        ("root.zip", zip_bytes({"/evil.txt": b"x"})),
        ("back.zip", zip_bytes({"a\\..\\..\\evil.txt": b"x"})),
        ("up.tgz", tar_bytes({"../evil.txt": b"x"})),
        ("link.tgz", tar_bytes({"a": b"x"}, link=("door", "/etc"))),
    ],
)
def test_members_never_leave_the_folder(file: str, content: bytes, tmp_path: Path) -> None:
    (tmp_path / file).write_bytes(content)
    with pytest.raises(InputError, match="leaves the folder"):
        unpack(tmp_path / file, tmp_path / "deep" / "set")
    assert not list(tmp_path.rglob("evil.txt"))


def test_links_in_a_zip_are_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as zipped:
        info = zipfile.ZipInfo("door")
        info.external_attr = 0o120777 << 16
        zipped.writestr(info, "/etc")
    with pytest.raises(InputError, match="leaves the folder"):
        unpack(tmp_path / "a.zip", tmp_path / "set")


@pytest.mark.parametrize("file", ["a.zip", "a.tgz"])
@pytest.mark.parametrize("cut", [0, 60])
def test_damaged_archives(file: str, cut: int, tmp_path: Path) -> None:
    whole = zip_bytes({"f": b"1" * 999}) if file == "a.zip" else tar_bytes({"f": bytes(range(256)) * 40})
    (tmp_path / file).write_bytes(whole[:cut])
    with pytest.raises(InputError, match="damaged"):
        unpack(tmp_path / file, tmp_path / "set")
