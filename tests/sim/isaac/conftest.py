from support.fake_isaac.fixtures import assets, fake, make_fake

__all__ = ["assets", "fake", "make_fake"]
