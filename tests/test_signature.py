"""Signed model files: flown by those who trust the key, refused by them when anything is amiss."""

from pathlib import Path

import onnx
import pytest
from small_run import model_file
from tiny_online import tiny_options
from toy import write_toy_set

from horizon_dl.cli import main
from horizon_dl.errors import InputError
from horizon_dl.runtime.checksum import BLANK, BLANK_SIGNED, checksummed, read_checksummed
from horizon_dl.runtime.hot_reload import HotReloadedModel
from horizon_dl.runtime.model import ObstacleModel
from horizon_dl.runtime.signature import read_signer, read_verifier

serialization = pytest.importorskip("cryptography.hazmat.primitives.serialization")


@pytest.fixture(scope="module")
def keys(tmp_path_factory) -> dict[str, Path]:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.asymmetric.rsa import generate_private_key

    folder, found = tmp_path_factory.mktemp("keys"), {}
    pem, form = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8
    for name in ("mine", "theirs", "rsa"):
        key = generate_private_key(65537, 2048) if name == "rsa" else Ed25519PrivateKey.generate()
        found[name], found[f"{name}.pub"] = folder / name, folder / f"{name}.pub"
        found[name].write_bytes(key.private_bytes(pem, form, serialization.NoEncryption()))
        found[f"{name}.pub"].write_bytes(
            key.public_key().public_bytes(pem, serialization.PublicFormat.SubjectPublicKeyInfo)
        )
    return found


def signed_file(path: Path, key: Path | None) -> Path:
    """The small model, checksummed anew."""
    file = onnx.load(model_file())
    file.doc_string = BLANK if key is None else BLANK_SIGNED
    path.write_bytes(checksummed(file.SerializeToString(deterministic=True), key and read_signer(key)))
    return path


def test_a_signed_file_is_read_by_everybody_and_trusted_by_key(keys, tmp_path):
    path = signed_file(tmp_path / "m.onnx", keys["mine"])
    ObstacleModel.load(path)
    ObstacleModel.load(path, trusted=read_verifier(keys["mine.pub"]))
    with pytest.raises(InputError, match="is not signed by the one who is trusted"):
        ObstacleModel.load(path, trusted=read_verifier(keys["theirs.pub"]))
    with pytest.raises(InputError, match="is not signed; export it with --sign"):
        ObstacleModel.load(model_file(), trusted=read_verifier(keys["mine.pub"]))


def test_whatever_is_changed_in_a_signed_file_is_found(keys, tmp_path):
    path = signed_file(tmp_path / "m.onnx", keys["mine"])
    trusted, whole = read_verifier(keys["mine.pub"]), path.read_bytes()
    places = [*range(0, 8 * 420, 7), *range(8 * 420, 8 * len(whole), 8 * len(whole) // 50)]
    for bit in places:
        damaged = bytearray(whole)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        with pytest.raises(InputError):
            read_checksummed(path, trusted)
    # Somebody who can seal, but has no key: the old signature on new content.
    file = onnx.load_from_string(whole)
    file.producer_name = "somebody else"
    file.doc_string = BLANK_SIGNED
    old = bytes.fromhex(whole[: whole.index(b"ed25519 ") + 136][-128:].decode())
    path.write_bytes(checksummed(file.SerializeToString(deterministic=True), lambda _: old))
    read_checksummed(path)
    with pytest.raises(InputError, match="is not signed by the one"):
        read_checksummed(path, trusted)


def test_a_fresh_file_of_somebody_else_is_refused_in_flight(keys, tmp_path):
    path = signed_file(tmp_path / "m.onnx", keys["mine"])
    followed = HotReloadedModel.load(path, trusted=read_verifier(keys["mine.pub"]))
    signed_file(path, keys["theirs"])
    followed._load()
    assert followed.refused == 1
    assert "is not signed by the one" in followed.problem


def test_what_a_learner_hands_over_is_signed_and_trusted(keys, tmp_path, monkeypatch):
    data, path = write_toy_set(tmp_path / "set", frames=8), tmp_path / "run" / "model.onnx"

    def learn(key: str) -> None:
        arguments = [
            "online",
            str(data),
            "--out",
            str(path.parent),
            *tiny_options(),
            "--no-film",
            "--restart",
        ]
        assert main([*arguments, "--export-every", "0.001", "--sign", str(keys[key])]) == 0

    learn("mine")
    # What is tried is who made the file; a net of eight frames is not to be flown.
    monkeypatch.setattr("horizon_dl.runtime.hot_reload.not_airworthy", lambda *_: None)
    followed = HotReloadedModel.load(path, trusted=read_verifier(keys["mine.pub"]))
    path.write_bytes(path.read_bytes())
    followed._load()
    assert (followed.refused, followed.problem) == (0, None)
    learn("theirs")
    followed._load()
    assert followed.refused == 1
    assert "is not signed by the one" in followed.problem


def test_a_key_without_files_to_sign_is_wrong_use(keys, tmp_path, capsys):
    data = write_toy_set(tmp_path / "set", frames=8)
    assert main(["online", str(data), "--out", str(tmp_path / "run"), "--sign", str(keys["mine"])]) == 2
    assert "--sign: has no meaning without --export-every" in capsys.readouterr().err


def test_what_is_no_key_is_one_line(keys, tmp_path, capsys):
    (tmp_path / "text").write_text("hello")
    for path in (tmp_path / "text", keys["mine.pub"], keys["rsa"]):
        with pytest.raises(InputError, match="holds no Ed25519 private key"):
            read_signer(path)
    for path in (tmp_path / "text", keys["mine"], keys["rsa.pub"]):
        with pytest.raises(InputError, match="holds no Ed25519 public key"):
            read_verifier(path)
    arguments = ["fly", str(model_file()), "--source", str(tmp_path), "--mavlink", "udpout:127.0.0.1:9"]
    assert main([*arguments, "--trust", str(tmp_path / "nothing")]) == 2
    assert "nothing: does not exist" in capsys.readouterr().err
